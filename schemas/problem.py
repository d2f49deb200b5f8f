"""A trajectory-optimization problem: the document that clients post."""

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Label, Posted
from schemas.expressions import Expression
from schemas.guesses import Guess, LinearGuess
from schemas.limits import MODEL_LIMITS
from schemas.methods import HermiteSimpson, Method
from schemas.phases import Constraint, Phase
from schemas.values import Bound, Scalar


class Objective(Posted):
    """What to minimize: over integrals, initial and final values, and the duration."""

    minimize: Expression


class Refinement(Posted):
    """Refine the mesh until the largest relative error of a segment is below ``tolerance``.

    Segments are cut where the error is too large and, with ``merge``, joined where it is
    needlessly small; Radau raises the degree of segments where the motion is smooth. With
    ``switches``, jumps of controls and changes of constraint activity are found, and the phase is
    split there at free times, so that bang-bang controls come out exact.
    """

    tolerance: float = Field(default=1e-6, gt=1e-13, le=1.0)
    max_iterations: int = Field(default=8, ge=1, le=50, description="Meshes at the most.")
    max_segments: int = Field(default=2000, ge=1, le=MODEL_LIMITS.segments)
    max_subdivisions: int = Field(default=5, ge=2, le=20, description="Parts of one segment.")
    max_points: int = Field(
        default=10, ge=1, le=20, description="Collocation points of one segment, for Radau."
    )
    seconds: float | None = Field(
        default=None, gt=0, description="Start no further mesh after so much time."
    )
    merge: bool = True
    switches: bool = False


class SolverSettings(Posted):
    """The NLP solver: which, how long, how tight."""

    backend: Literal["ipopt", "fatrop", "uno", "sqp"] = "ipopt"
    max_iterations: int = Field(default=3000, ge=0, le=100_000, description="Per mesh.")
    tolerance: float = Field(default=1e-8, gt=1e-14, le=1e-2)
    portfolio: bool = Field(
        default=False, description="Try other strategies where the first one fails."
    )


class Limits(Posted):
    """What one solve may use; the service caps both."""

    seconds: float = Field(default=600.0, gt=0, le=86_400)
    megabytes: int = Field(default=4096, ge=256, le=1_000_000)


class CertificateSettings(Posted):
    """Tolerances of the certificate.

    ``tolerance`` judges dynamics and objective: ten times the refinement's where that is on,
    else 1e-3, unless given. ``constraint_tolerance`` judges bounds and constraints, relative to
    one plus the limit's size.
    """

    tolerance: float | None = Field(default=None, gt=0, le=1.0)
    constraint_tolerance: float = Field(default=1e-4, gt=0, le=1.0)


class Smoothing(Posted):
    """Smooth forms: ``tanh``: abs(x) = x tanh(x / a); ``sqrt``: sqrt(x^2 + a^2) - a."""

    tanh: float | None = Field(default=None, gt=0, le=1e6)
    sqrt: float | None = Field(default=None, gt=0, le=1e6)

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.tanh is None) == (self.sqrt is None):
            raise PydanticCustomError("one_smoothing", "give either 'tanh' or 'sqrt'")
        return self


def _treatment(raw: Any) -> str:
    return "slack" if isinstance(raw, str) else "Smoothing"


class Nonsmooth(Posted):
    """How ``abs``, ``min`` and ``max`` in objectives are treated (003, section 7.10).

    ``slack``: exactly, by slack variables; a smoothing: approximately, everywhere. Null leaves
    them as they are.
    """

    abs: Annotated[
        Annotated[Literal["slack"], Tag("slack")] | Annotated[Smoothing, Tag("Smoothing")],
        Discriminator(_treatment),
    ]


class Static(Posted):
    """A number that the solver chooses, the same at all times: a length, a mass, a gain."""

    bounds: Bound
    guess: Scalar | None = None


class Known(Posted):
    """What is known of the optimum; ignored by the solver, checked by the tests."""

    quantity: str
    value: float
    tolerance: float = Field(gt=0)
    source: str


class Problem(Posted):
    """A problem, as posted. See docs/language.md."""

    name: Label = "problem"
    description: str = Field(default="", max_length=4000)
    static: dict[Identifier, Static] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.static, description="Free parameters."
    )
    phases: list[Phase] = Field(min_length=1, max_length=MODEL_LIMITS.phases)
    linkages: list[Constraint] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.constraints,
        description="Constraints over the ends of phases: stance.final.x, flight.initial.x.",
    )
    objective: Objective | None = None
    method: Method = Field(default_factory=lambda: HermiteSimpson(kind="hermite_simpson"))
    refinement: Refinement | None = Field(default_factory=Refinement)
    nonsmooth: Nonsmooth | None = None
    guess: Guess = Field(default_factory=LinearGuess)
    stages: list[dict[str, Any]] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.stages,
        description="Merge patches on the problem, each solved from the last one's solution.",
    )
    halvings: int = Field(
        default=0,
        ge=0,
        le=6,
        description="How often the way to a stage that fails is halved: numbers in between.",
    )
    multistart: int = Field(default=1, ge=1, le=MODEL_LIMITS.multistart, description="Guesses.")
    solver: SolverSettings = Field(default_factory=SolverSettings)
    limits: Limits = Field(default_factory=Limits)
    certificate: CertificateSettings = Field(default_factory=CertificateSettings)
    known: list[Known] = Field(default_factory=list, max_length=50)
