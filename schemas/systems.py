"""Systems: what moves, as data; one model a kind.

Whatever its kind, a system answers with ``state_names`` (velocities are called ``d(q)``),
``control_names`` and ``equations``, so that readers need not know the kinds.
"""

from collections.abc import Iterator
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import AlsoNamed, Identifier, Posted
from schemas.expressions import Expression
from schemas.limits import MODEL_LIMITS
from schemas.mechanisms import Mechanism
from schemas.pointers import Part
from schemas.urdf import Urdf
from schemas.values import Scalar

Parameters = Annotated[
    dict[Identifier, Scalar],
    Field(max_length=MODEL_LIMITS.parameters, description="Constants; one may use those before."),
]
Definitions = Annotated[
    dict[Identifier, Expression],
    Field(description="Named intermediates; one may use those before it."),
]
Controls = Annotated[list[Identifier], Field(max_length=MODEL_LIMITS.controls)]

Equation = tuple[tuple[Part, ...], str, Expression]
"""An equation of motion: where it stands in the system, what to call it, its expression."""


class Ode(Posted):
    """First-order dynamics: one derivative per state, over named intermediates."""

    kind: Literal["ode"]
    parameters: Parameters = Field(default_factory=dict)
    states: list[Identifier] = Field(min_length=1, max_length=MODEL_LIMITS.states)
    controls: Controls = Field(default_factory=list)
    define: Definitions = Field(default_factory=dict)
    derivatives: dict[Identifier, Expression] = Field(
        description="The time derivative of each state."
    )

    @property
    def state_names(self) -> list[str]:
        """The states."""
        return list(self.states)

    @property
    def control_names(self) -> list[str]:
        """The controls."""
        return list(self.controls)

    def equations(self) -> Iterator[Equation]:
        """The derivatives, in the order in which they were written."""
        for name, expression in self.derivatives.items():
            yield ("derivatives", name), f"derivative of {name}", expression


class SecondOrder(Posted):
    """Second-order dynamics: accelerations, or residuals that vanish along the motion.

    Expressions see the coordinates ``q``, their velocities ``d(q)`` and, in residuals, their
    accelerations ``dd(q)``.
    """

    kind: Literal["second_order"]
    parameters: Parameters = Field(default_factory=dict)
    coordinates: list[Identifier] = Field(min_length=1, max_length=MODEL_LIMITS.states // 2)
    controls: Controls = Field(default_factory=list)
    define: Definitions = Field(default_factory=dict)
    accelerations: dict[Identifier, Expression] | None = Field(
        default=None, description="The second time derivative of each coordinate."
    )
    residual: list[Expression] | None = Field(
        default=None, description="As many as coordinates; each is zero along the motion."
    )

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        if (self.accelerations is None) == (self.residual is None):
            raise PydanticCustomError(
                "one_form", "give either 'accelerations' or 'residual', and not both"
            )
        return self

    @property
    def state_names(self) -> list[str]:
        """Coordinates, then velocities."""
        return [*self.coordinates, *(f"d({name})" for name in self.coordinates)]

    @property
    def control_names(self) -> list[str]:
        """The controls."""
        return list(self.controls)

    def equations(self) -> Iterator[Equation]:
        """Accelerations or residuals, in the order in which they were written."""
        for name, expression in (self.accelerations or {}).items():
            yield ("accelerations", name), f"acceleration of {name}", expression
        for index, expression in enumerate(self.residual or []):
            yield ("residual", index), f"residual {index}", expression


class ClosedForm(Posted):
    """A motion known in closed form, such as ballistic flight: no defects, no controls.

    Each state is an expression over the phase's own start (``initial.x``, ``initial.t``) and the
    time ``t``; at the start it must give the state back.
    """

    kind: Literal["closed_form"]
    parameters: Parameters = Field(default_factory=dict)
    define: Definitions = Field(default_factory=dict)
    states: dict[Identifier, Expression] = Field(min_length=1, max_length=MODEL_LIMITS.states)

    @property
    def state_names(self) -> list[str]:
        """The states."""
        return list(self.states)

    @property
    def control_names(self) -> list[str]:
        """None: nothing steers the motion."""
        return []

    def equations(self) -> Iterator[Equation]:
        """The states' formulas."""
        for name, expression in self.states.items():
            yield ("states", name), f"state {name}", expression


System = Annotated[
    Ode | SecondOrder | ClosedForm | Mechanism | Urdf,
    Field(discriminator="kind"),
    AlsoNamed(
        (("kind", "=library"), ("name", "string"), ("parameters", "object")),
        "The system of the first phase of an example, perhaps with other parameters.",
        optional=("parameters",),
    ),
]
SYSTEMS: tuple[type[Posted], ...] = (Ode, SecondOrder, ClosedForm, Mechanism, Urdf)
