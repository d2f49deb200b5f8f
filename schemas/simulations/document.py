"""The document: a system set going from a given state.

What comes back is `schemas.simulated.SimulationResult`.
"""

from typing import Annotated, Literal, Self

from pydantic import FailFast, Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import AlsoNamed, Identifier, Label, Posted, Series
from schemas.expressions import Expression
from schemas.guesses import SolutionPhase
from schemas.limits import MODEL_LIMITS
from schemas.problem import Limits
from schemas.systems import System
from schemas.values import Scalar

MAX_SAMPLES = 20_000
MAX_GUARDS = 64

Times = Annotated[list[float], FailFast()]
Interpolation = Literal["hold", "linear", "cubic"]


class Smooth(Posted):
    """One smooth motion: no contact opens or closes; those of the system's ``mode`` are held.

    DOP853 of order 8 with ``tolerance``, relative, of each step.
    """

    kind: Literal["smooth"] = "smooth"
    tolerance: float = Field(default=1e-10, gt=2.3e-14, le=1e-2)
    max_step: float | None = Field(default=None, gt=0, le=1e6, description="s.")


class Events(Posted):
    """Smooth motions between events: impacts, lift-off, sticking and slipping, and own guards.

    No event is missed that lasts longer than ``max_step``. What leaves an impact slower than
    ``escape_velocity`` stays in touch, which ends accumulations of impacts (Zeno).
    """

    kind: Literal["events"]
    tolerance: float = Field(default=1e-10, gt=2.3e-14, le=1e-2)
    max_step: float = Field(default=0.01, gt=0, le=1e6, description="s.")
    escape_velocity: float = Field(default=1e-6, ge=0, le=1e3, description="m/s.")
    max_events: int = Field(default=10_000, ge=1, le=1_000_000)
    restitution: Scalar | None = Field(default=None, description="Of all pairs, 0 to 1.")


class TimeStepping(Posted):
    """Fixed steps, in which impulses of all contacts are found at once (Stewart and Trinkle).

    ``directions`` of the friction polygon: two are exact in the plane, more serve URDF systems.
    """

    kind: Literal["time_stepping"]
    step: float = Field(default=1e-3, gt=0, le=1.0, description="s.")
    directions: int = Field(default=2, ge=2, le=32)
    restitution: Scalar | None = Field(default=None, description="Of all pairs, 0 to 1.")


SimulationMethod = Annotated[Smooth | Events | TimeStepping, Field(discriminator="kind")]
SIMULATION_METHODS: tuple[type[Posted], ...] = (Smooth, Events, TimeStepping)


class ExpressionSignal(Posted):
    """Formulas over time, states and whatever the system defines."""

    kind: Literal["expressions"]
    values: dict[Series, Expression]


class SampledSignal(Posted):
    """Values at given times, which increase; before the first and after the last they stay."""

    kind: Literal["samples"]
    time: Times = Field(min_length=2, max_length=MAX_SAMPLES)
    values: dict[Series, Annotated[list[float], FailFast()]]
    interpolation: Interpolation = "linear"


class SolutionSignal(Posted):
    """The curves of an earlier result, phase after phase; beyond them their last values stay."""

    kind: Literal["solution"]
    phases: list[SolutionPhase] = Field(min_length=1, max_length=64)
    static: dict[Identifier, float] = Field(default_factory=dict)


Signal = Annotated[
    ExpressionSignal | SampledSignal | SolutionSignal,
    Field(discriminator="kind"),
    AlsoNamed((("from_job", "string"),), "The solution of an own, finished job, by its id."),
]


class GainSchedule(Posted):
    """Gains at given times, with straight lines between: control -> state -> values."""

    time: Times = Field(min_length=2, max_length=MAX_SAMPLES)
    gains: dict[Series, dict[Series, Annotated[list[float], FailFast()]]]


class Feedback(Posted):
    """Linear feedback on top of the controls: ``u = u_ref(t) - K(t) (x - x_ref(t))``.

    Gains, control -> state, are formulas over ``t``, or a schedule; what is left out is 0.
    ``reference`` is x_ref; left out, it is that of the controls' solution, else 0.
    """

    gains: dict[Series, dict[Series, Expression]] | None = None
    schedule: GainSchedule | None = None
    reference: Signal | None = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.gains is None) == (self.schedule is None):
            raise PydanticCustomError("one_gain", "give either 'gains' or 'schedule'")
        return self


class Guard(Posted):
    """An event of any system: ``expression`` passes zero, in a ``direction``.

    Then each state in ``reset`` takes a new value, computed from those before; a terminal event
    ends the simulation.
    """

    name: Identifier
    expression: Expression
    direction: Literal["falling", "rising", "both"] = "both"
    reset: dict[Series, Expression] = Field(default_factory=dict)
    terminal: bool = False


class Simulation(Posted):
    """A system and the state it starts from.

    States and controls that are left out are 0; of a quaternion the first number is 1.
    """

    name: Label = "simulation"
    description: str = Field(default="", max_length=4000)
    system: System
    static: dict[Identifier, Scalar] = Field(
        default_factory=dict,
        max_length=MODEL_LIMITS.static,
        description="Values of names that a problem would leave to the solver.",
    )
    initial: dict[Series, Scalar] = Field(default_factory=dict)
    start: Scalar = Field(default_factory=lambda: Scalar.read(0), description="Initial t, s.")
    duration: Scalar = Field(description="s.")
    method: SimulationMethod = Field(default_factory=Smooth)
    controls: Signal | None = None
    feedback: Feedback | None = None
    events: list[Guard] = Field(default_factory=list, max_length=MAX_GUARDS)
    samples: int = Field(
        default=201, ge=2, le=MAX_SAMPLES, description="Equal times at which series are listed."
    )
    limits: Limits = Field(default_factory=Limits)
