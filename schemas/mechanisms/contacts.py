"""Where a mechanism may touch: contact points, surfaces, shapes of bodies, and permitted pairs."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted
from schemas.expressions import Expression
from schemas.mechanisms.parts import ONE, ZERO, Place, Vector, origin

HEIGHT_NAME = "x"
"""The name that a surface's height is an expression of."""

Mode = Literal["sticking", "sliding_left", "sliding_right", "sliding", "frictionless"]
"""What a touching contact does: ``sliding_right`` moves along the tangent, which points to +x
on level ground; ``sliding`` leaves the direction open, without friction is ``frictionless``."""


class Contact(Place):
    """A point of a body that may touch, or a circle about it."""

    radius: Expression = Field(default=ZERO, description="Of a circle, m.")


class Surface(Posted):
    """Fixed ground; free above it. ``height`` is an expression of ``x`` (and parameters).

    The gap is ``(y - height) / sqrt(1 + slope^2)``, less the contact's radius, height and slope
    taken at the contact's x.
    """

    height: Expression = ZERO
    friction: Expression = ONE
    restitution: Expression = Field(default=ZERO, description="For simulations, 0 to 1.")


class Shape(Posted):
    """A circle or an ellipse of a body that contact points may touch from outside.

    The gap to an ellipse is a distance to first order: with x, y the contact in the body's frame,
    from ``at``, and ``g = hypot(x/a, y/b)``, it is ``g (g - 1) / hypot(x/a^2, y/b^2)``, less the
    contact's radius; for a circle that is exact.
    """

    body: Identifier
    at: Vector = Field(default_factory=origin)
    circle: Expression | None = Field(default=None, description="Radius, m.")
    ellipse: Vector | None = Field(default=None, description="Half axes, m.")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.circle is None) == (self.ellipse is None):
            raise PydanticCustomError("one_shape", "give either 'circle' or 'ellipse'")
        return self


class Pair(Posted):
    """A contact and what it may touch: a surface or a shape. Friction where it is not that one's.

    The pair's name is that of ``contact.NAME.normal`` and its kin.
    """

    contact: Identifier
    against: Identifier
    friction: Expression | None = None
    restitution: Expression | None = None


Contacts = Annotated[dict[Identifier, Contact], Field(default_factory=dict, max_length=64)]
