"""A trajectory-optimization problem: the document that clients post."""

from typing import Annotated, Literal

from pydantic import FailFast, Field

from schemas.base import Identifier, Label, Posted
from schemas.expressions import Expression
from schemas.limits import MODEL_LIMITS
from schemas.methods import HermiteSimpson, Method
from schemas.phases import Phase
from schemas.values import Scalar


class LinearGuess(Posted):
    """Straight lines between the initial and the final values; open ends take the other end."""

    kind: Literal["linear"] = "linear"


class ConstantGuess(Posted):
    """The same value all along; names left out take the linear guess."""

    kind: Literal["constant"]
    values: dict[Identifier, Scalar]


class PointsGuess(Posted):
    """Values at given times, straight lines between; names left out take the linear guess.

    ``time`` increases; it is stretched onto the guessed span of the phase.
    """

    kind: Literal["points"]
    time: Annotated[list[float], FailFast()] = Field(min_length=2, max_length=10_000)
    values: dict[Identifier, Annotated[list[Scalar], FailFast()]]


Guess = Annotated[LinearGuess | ConstantGuess | PointsGuess, Field(discriminator="kind")]


class Objective(Posted):
    """What to minimize: over integrals, initial and final values, and the duration."""

    minimize: Expression


class Refinement(Posted):
    """Refine the mesh until the largest relative error of a segment is below ``tolerance``."""

    tolerance: float = Field(default=1e-6, gt=1e-13, le=1.0)
    max_iterations: int = Field(default=8, ge=1, le=50, description="Meshes at the most.")
    max_segments: int = Field(default=2000, ge=1, le=MODEL_LIMITS.segments)
    max_subdivisions: int = Field(default=5, ge=2, le=20, description="Parts of one segment.")


class SolverSettings(Posted):
    """The NLP solver: which, how long, how tight."""

    backend: Literal["ipopt"] = "ipopt"
    max_iterations: int = Field(default=3000, ge=0, le=100_000, description="Per mesh.")
    tolerance: float = Field(default=1e-8, gt=1e-14, le=1e-2)


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
    phases: list[Phase] = Field(min_length=1, max_length=MODEL_LIMITS.phases)
    objective: Objective | None = None
    method: Method = Field(default_factory=lambda: HermiteSimpson(kind="hermite_simpson"))
    refinement: Refinement | None = Field(default_factory=Refinement)
    guess: Guess = Field(default_factory=LinearGuess)
    solver: SolverSettings = Field(default_factory=SolverSettings)
    limits: Limits = Field(default_factory=Limits)
    certificate: CertificateSettings = Field(default_factory=CertificateSettings)
    known: list[Known] = Field(default_factory=list, max_length=50)
