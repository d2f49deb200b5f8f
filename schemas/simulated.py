"""What a simulation returns: the motion as one phase of a result, and what happened on the way."""

from enum import StrEnum
from typing import Literal

from pydantic import Field

from schemas.base import Strict
from schemas.results import FORMAT, PhaseResult, Reproduce


class SimulationStatus(StrEnum):
    """How the motion ended. ``finished``: all of the duration."""

    FINISHED = "finished"
    STOPPED = "stopped"
    """A terminal event."""
    ZENO = "zeno"
    """More events than allowed: they accumulate."""
    PAINLEVE = "painleve"
    """No contact forces agree with Coulomb's law, or they jam the motion."""
    DIVERGED = "diverged"
    """The steps vanish, or a state passes all bounds."""
    TIME_LIMIT = "time_limit"
    STEP_LIMIT = "step_limit"
    """As many steps as a simulation may have."""
    CANCELLED = "cancelled"
    INVALID_NUMBER = "invalid_number"


EventKind = Literal["impact", "touch", "lift", "stick", "slip", "guard"]
"""``touch``: a contact that stays; ``impact``: one with an impulse, which may stay, too."""


class SimulationEvent(Strict):
    """Something that happened at an instant.

    ``name`` is that of the pair, the joint of a limit, or the guard. Impulses in N s (N m s for
    joints); ``gap_rate`` is d(gap) before and after, m/s.
    """

    time: float
    kind: EventKind
    name: str
    normal: float | None = None
    tangential: float | None = None
    gap_rate: tuple[float, float] | None = None


class ModeSpan(Strict):
    """Which contacts touched from ``start`` to ``end``, and how; those left out were open."""

    start: float
    end: float
    contacts: dict[str, str]


class ModeSequence(Strict):
    """The modes of a motion in order; ``distinct`` ones of ``possible`` (4 to the contacts)."""

    contacts: list[str]
    modes: list[ModeSpan]
    distinct: int
    possible: int


class Energy(Strict):
    """Of a mechanism, in J. ``drift`` is how far it strays, as a share: the error of the method.

    The largest change over the largest kinetic energy, or what the potential one ranges over, if
    that is more; null where something drives or brakes, so that the energy is to change.
    """

    initial: float | None
    final: float | None
    drift: float | None


class SimulationTiming(Strict):
    """Wall-clock seconds, and how often the dynamics were evaluated."""

    build: float
    simulate: float
    total: float
    evaluations: int = 0
    steps: int = 0


class SimulationResult(Strict):
    """A finished simulation. ``phases`` has one entry, of the shape of a solution's phases.

    A jump repeats its time in the groups, and is a break of the curves. Where the motion ended
    early, the series end there.
    """

    format: int = FORMAT
    kind: Literal["simulation"] = "simulation"
    name: str
    status: SimulationStatus
    message: str
    advice: list[str] = Field(default_factory=list)
    warnings: list[str] = Field(default_factory=list)
    phases: list[PhaseResult]
    events: list[SimulationEvent] = Field(default_factory=list)
    mode_sequence: ModeSequence | None = None
    energy: Energy | None = None
    timing: SimulationTiming
    reproduce: Reproduce
