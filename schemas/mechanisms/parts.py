"""What mechanisms are made of: places, bodies, and the joints between them."""

from typing import Annotated, Literal

from pydantic import Field

from schemas.base import Identifier, Posted
from schemas.expressions import Expression
from schemas.values import Bound

ZERO = Expression.read(0)
ONE = Expression.read(1)

Vector = Annotated[
    list[Expression],
    Field(min_length=2, max_length=2, description="x and y, constant: parameters, statics."),
]

Corner = Annotated[list[float], Field(min_length=2, max_length=2, description="x and y, m.")]

GROUND = "ground"
"""The parent of what is fixed to the world."""


def origin() -> list[Expression]:
    """The zero vector."""
    return [ZERO, ZERO]


class Place(Posted):
    """A point of a body, in the body's own frame; of the world's where the body is ``ground``."""

    body: Identifier
    at: Vector = Field(default_factory=origin)


class Body(Posted):
    """A rigid body in the plane.

    Its frame turns counterclockwise by the angle. Without mass and inertia it is a mere frame
    between two joints. ``outline`` is drawn, in the body's frame; nothing else depends on it.
    """

    mass: Expression | None = Field(default=None, description="kg, positive.")
    inertia: Expression | None = Field(default=None, description="kg m^2, about the com.")
    com: Vector = Field(default_factory=origin, description="Centre of mass, in m.")
    outline: list[Corner] = Field(default_factory=list, max_length=200)


class _Joint(Posted):
    """A joint from a place of its parent to a place of its child."""

    parent: Identifier = GROUND
    child: Identifier
    at: Vector = Field(default_factory=origin, description="In the parent's frame, m.")
    to: Vector = Field(default_factory=origin, description="In the child's frame, m.")
    angle: Expression = Field(default=ZERO, description="Of child to parent at zero, rad.")


class Revolute(_Joint):
    """A hinge; its coordinate is the angle from parent to child, counterclockwise, in rad."""

    kind: Literal["revolute"]
    limits: Bound | None = None


class Prismatic(_Joint):
    """A slider along ``axis`` (of the parent's frame, made a unit vector); coordinate in m."""

    kind: Literal["prismatic"]
    axis: Vector
    limits: Bound | None = None


class Welded(_Joint):
    """No motion between the two; no coordinate."""

    kind: Literal["welded"]


class Floating(Posted):
    """A body free in the plane; its coordinates are ``BODY.x``, ``BODY.y`` and ``BODY.angle``."""

    kind: Literal["floating"]
    child: Identifier


Joint = Annotated[Revolute | Prismatic | Welded | Floating, Field(discriminator="kind")]


class Loop(Posted):
    """A pin between two places that closes a loop of bodies.

    Its force, ``loop.NAME.x`` and ``.y`` in the world's frame, acts on the second place's body, and
    the opposite on that of the first.
    """

    between: list[Place] = Field(min_length=2, max_length=2)
