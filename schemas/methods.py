"""The transcription methods a problem may ask for; one model a method, told apart by ``kind``."""

from typing import Annotated, Literal

from pydantic import Field

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


Transcribed = Trapezoidal | HermiteSimpson | Radau | ChebyshevLobatto | MultipleShooting | DirCol5i
"""The methods that are transcriptions."""

Method = Annotated[
    Trapezoidal | HermiteSimpson | Radau | ChebyshevLobatto | MultipleShooting | DirCol5i | Hybrid,
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

SCHEDULES: tuple[type[Posted], ...] = (Hybrid,)
"""Those that are made of others."""
