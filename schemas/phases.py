"""A phase: a system over a span of time, with bounds, ends, constraints and integrals."""

from typing import Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted, Series
from schemas.expressions import Expression
from schemas.guesses import Guess
from schemas.limits import MODEL_LIMITS
from schemas.methods import Method
from schemas.periodic import Periodic
from schemas.systems import System
from schemas.values import Bound, Scalar


class Time(Posted):
    """When a phase starts and ends; a pair leaves the time free within bounds.

    The first phase starts at 0 unless ``initial`` is given. A later one starts when the one
    before it ends, and has no ``initial``. ``final`` is an instant, ``duration`` a length of
    time; at least one of them is given.
    """

    initial: Bound | None = None
    final: Bound | None = None
    duration: Bound | None = None

    @property
    def start(self) -> Bound:
        """When a first phase starts: at 0 unless told."""
        return self.initial or Bound.read(0)

    @model_validator(mode="after")
    def _ends(self) -> Self:
        if self.final is None and self.duration is None:
            raise PydanticCustomError("open_time", "give 'final', 'duration' or both")
        return self


class Constraint(Posted):
    """``lower <= expression <= upper``, along the phase (path) or over its ends (boundary)."""

    name: Identifier
    expression: Expression
    lower: Scalar | None = None
    upper: Scalar | None = None

    @model_validator(mode="after")
    def _limited(self) -> Self:
        if self.lower is None and self.upper is None:
            raise PydanticCustomError("open_constraint", "give 'lower', 'upper' or both")
        return self


class Phase(Posted):
    """One phase of the motion."""

    name: Identifier = "phase"
    system: System
    time: Time
    bounds: dict[Series, Bound] = Field(
        default_factory=dict,
        description="Limits on states, controls and their derivatives along the phase.",
    )
    initial: dict[Series, Bound] = Field(default_factory=dict)
    final: dict[Series, Bound] = Field(default_factory=dict)
    path: list[Constraint] = Field(default_factory=list, max_length=MODEL_LIMITS.constraints)
    boundary: list[Constraint] = Field(default_factory=list, max_length=MODEL_LIMITS.constraints)
    integrals: dict[Identifier, Expression] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.integrals
    )
    periodic: Periodic | None = Field(default=None, description="The phase ends as it starts.")
    method: Method | None = Field(default=None, description="Instead of the problem's.")
    guess: Guess | None = Field(default=None, description="Instead of the problem's.")
