"""The transcription methods a problem may ask for; one model a method, told apart by ``kind``."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted
from schemas.limits import MODEL_LIMITS
from schemas.mechanisms.contacts import Mode
from schemas.values import Bound

Segments = Annotated[
    int, Field(ge=1, le=MODEL_LIMITS.segments // 4, description="Segments of the first mesh.")
]


class Trapezoidal(Posted):
    """Trapezoidal collocation: control piecewise linear, state piecewise quadratic, order 2."""

    kind: Literal["trapezoidal"]
    segments: Segments = 50


class HermiteSimpson(Posted):
    """Hermite-Simpson collocation: state piecewise cubic, order 4.

    ``separated`` keeps the midpoint states as variables (better on few segments),
    ``compressed`` eliminates them (better on many). A ``linear`` control does not overshoot
    between nodes where a bound is active; a ``quadratic`` one is more accurate where it is smooth.
    """

    kind: Literal["hermite_simpson"]
    segments: Segments = 25
    form: Literal["separated", "compressed"] = "separated"
    control: Literal["quadratic", "linear"] = "quadratic"


class Radau(Posted):
    """Legendre-Gauss-Radau collocation: state of degree ``points``, order 2 points - 1.

    A control may jump at every knot.
    """

    kind: Literal["radau"]
    segments: Segments = 10
    points: int = Field(default=4, ge=1, le=20, description="Collocation points of a segment.")


class ChebyshevLobatto(Posted):
    """Chebyshev-Lobatto collocation: one polynomial of high degree on each of few segments."""

    kind: Literal["chebyshev_lobatto"]
    segments: Segments = 1
    degree: int = Field(default=24, ge=2, le=100, description="Of the polynomials of a segment.")


class MultipleShooting(Posted):
    """Multiple shooting: Runge-Kutta steps of order 4 between knots, which alone have states."""

    kind: Literal["multiple_shooting"]
    segments: Segments = 20
    steps: int = Field(default=2, ge=1, le=50, description="Runge-Kutta steps of a segment.")


class DirCol5i(Posted):
    """Quintic Hermite splines for second-order systems, order 6: minimum jerk and snap."""

    kind: Literal["dircol5i"]
    segments: Segments = 12


class HybridMode(Posted):
    """One mode of a sequence: which contacts touch and what they do, and how long."""

    name: Identifier
    contacts: dict[Identifier, Mode] = Field(
        default_factory=dict, description="Contacts left out do not touch."
    )
    duration: Bound | None = Field(default=None, description="Seconds; free unless given.")


class Hybrid(Posted):
    """A mechanism with contacts in a given sequence of modes, each of them a phase of free length.

    Contacts that touch are held in place, with forces within the friction cone; where one begins
    to touch there is an impact. ``transcription`` says how each mode is solved; its ``segments``
    are shared among them. Result phases are called PHASE/MODE.
    """

    kind: Literal["hybrid"]
    transcription: Annotated[Trapezoidal | HermiteSimpson | Radau, Field(discriminator="kind")] = (
        Field(default_factory=lambda: HermiteSimpson(kind="hermite_simpson"))
    )
    sequence: list[HybridMode] = Field(min_length=1, max_length=MODEL_LIMITS.phases)

    @property
    def segments(self) -> int:
        """Of all modes together."""
        return self.transcription.segments


_SCHEDULE = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7)


class Relaxation(Posted):
    """How complementarity ``a b = 0`` is reached: relaxed to ``eps``, which falls along a schedule.

    ``equality``: every product is eps, a smooth contact model, of which also contacts that are
    open feel each other; ``inequality``: at most eps; ``summed``: the products of a step together
    at most eps; ``penalty``: their sum in the objective, over eps; ``fischer_burmeister``:
    ``a + b = sqrt(a^2 + b^2 + 2 eps)``. Products are of a gap in m or a speed in m/s, and of a
    force over the weight.
    Where a pass fails, a smaller step is tried, then the inequality. ``polish`` then fixes the
    smaller member of each pair at zero and solves once more, exactly.
    """

    form: Literal["equality", "inequality", "summed", "penalty", "fischer_burmeister"] | None = (
        Field(default=None, description="Left out: equality in the plane, inequality in space.")
    )
    schedule: list[Annotated[float, Field(gt=0, le=1e3)]] = Field(
        default_factory=lambda: list(_SCHEDULE), min_length=1, max_length=30
    )
    polish: bool = True

    @field_validator("schedule")
    @classmethod
    def _falling(cls, schedule: list[float]) -> list[float]:
        if any(a <= b for a, b in pairwise(schedule)):
            raise PydanticCustomError(
                "rising_schedule",
                "the schedule must fall from entry to entry",
                {"hint": "such as [0.1, 0.01, 0.001, 1e-5, 1e-7]"},
            )
        return schedule


class ContactImplicit(Posted):
    """Time stepping through contact without a mode schedule (000): the solver finds the sequence.

    Forces of contacts, friction and joint limits are decision variables under complementarity.
    ``discrete_gradient`` steps (the default) let contacts only take energy; ``backward_euler``
    steps are those of the paper, whose contacts can feed energy in.

    ``steps``: all equal, in a phase of given length (``fixed``) or of free length (``duration``);
    or in pairs of equal length, within which each step is free (``pairwise``, 000 section 3.4),
    within ``step_bounds`` times the mean one. ``friction``: ``sliding`` is Coulomb's law,
    ``no_slip`` lets nothing slide that presses (001). ``directions`` make the friction cone in
    space. ``slip_bound`` is the fastest slip, m/s. Segments are doubled until dissipation outside
    of impacts is below the share ``dissipation`` of the actuators' work, where refinement is on.
    """

    kind: Literal["contact_implicit"]
    segments: Segments = 20
    steps: Literal["fixed", "duration", "pairwise"] = "duration"
    step_bounds: list[float] = Field(
        default_factory=lambda: [0.4, 2.0],
        min_length=2,
        max_length=2,
        description="Times the mean.",
    )
    discretisation: Literal["discrete_gradient", "backward_euler"] | None = None
    relaxation: Relaxation = Field(default_factory=Relaxation)
    friction: Literal["sliding", "no_slip"] = "sliding"
    directions: int = Field(default=4, ge=4, le=64, multiple_of=2)
    slip_bound: float = Field(default=20.0, gt=0, le=1e4)
    stops: bool = Field(
        default=True, description="Joint limits push back; else motions avoid them."
    )
    dissipation: float = Field(default=0.2, gt=0, le=1)
    bearing: bool = Field(
        default=False,
        description="Let contacts that touch in the guess begin with their part of the weight.",
    )
    split_changes: bool = Field(
        default=False, description="Halve steps twice in which a contact opens or closes."
    )


class ContactImplicitPolished(Posted):
    """Contact-implicit steps first; the sequence that they find then by hybrid collocation."""

    kind: Literal["contact_implicit_polished"]
    steps: ContactImplicit = Field(default_factory=lambda: ContactImplicit(kind="contact_implicit"))
    transcription: Annotated[Trapezoidal | HermiteSimpson | Radau, Field(discriminator="kind")] = (
        Field(default_factory=lambda: Radau(kind="radau", points=3, segments=40))
    )

    @property
    def segments(self) -> int:
        """Of the first mesh."""
        return self.steps.segments


Transcribed = Trapezoidal | HermiteSimpson | Radau | ChebyshevLobatto | MultipleShooting | DirCol5i
"""The methods that are transcriptions."""

Method = Annotated[
    Trapezoidal
    | HermiteSimpson
    | Radau
    | ChebyshevLobatto
    | MultipleShooting
    | DirCol5i
    | Hybrid
    | ContactImplicit
    | ContactImplicitPolished,
    Field(discriminator="kind"),
]
METHODS: tuple[type[Posted], ...] = (
    Trapezoidal,
    HermiteSimpson,
    Radau,
    ChebyshevLobatto,
    MultipleShooting,
    DirCol5i,
)
"""Those that the engine transcribes; a schedule of modes is made of them."""

SCHEDULES: tuple[type[Posted], ...] = (Hybrid, ContactImplicit, ContactImplicitPolished)
"""Those that are made of others."""
