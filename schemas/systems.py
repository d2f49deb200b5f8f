"""Systems: what moves, as data; one model a kind."""

from typing import Literal

from pydantic import Field

from schemas.base import Identifier, Posted
from schemas.expressions import Expression
from schemas.limits import MODEL_LIMITS
from schemas.values import Scalar


class Ode(Posted):
    """First-order dynamics: one derivative per state, over named intermediates."""

    kind: Literal["ode"]
    parameters: dict[Identifier, Scalar] = Field(
        default_factory=dict,
        max_length=MODEL_LIMITS.parameters,
        description="Constants; one may use those before it.",
    )
    states: list[Identifier] = Field(min_length=1, max_length=MODEL_LIMITS.states)
    controls: list[Identifier] = Field(default_factory=list, max_length=MODEL_LIMITS.controls)
    define: dict[Identifier, Expression] = Field(
        default_factory=dict, description="Named intermediates; one may use those before it."
    )
    derivatives: dict[Identifier, Expression] = Field(
        description="The time derivative of each state."
    )


System = Ode
