"""A phase: a system over a span of time, with bounds, ends, constraints and integrals."""

from typing import Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted
from schemas.expressions import Expression
from schemas.limits import MODEL_LIMITS
from schemas.systems import System
from schemas.values import Bound, Scalar


class Time(Posted):
    """When a phase starts and ends; a pair leaves the time free within bounds."""

    initial: Bound = Field(default_factory=lambda: Bound.read(0))
    final: Bound


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
    bounds: dict[Identifier, Bound] = Field(
        default_factory=dict, description="Limits on states and controls along the phase."
    )
    initial: dict[Identifier, Bound] = Field(default_factory=dict)
    final: dict[Identifier, Bound] = Field(default_factory=dict)
    path: list[Constraint] = Field(default_factory=list, max_length=MODEL_LIMITS.constraints)
    boundary: list[Constraint] = Field(default_factory=list, max_length=MODEL_LIMITS.constraints)
    integrals: dict[Identifier, Expression] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.integrals
    )
