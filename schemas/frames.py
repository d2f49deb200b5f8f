"""The motion of a mechanism for drawing: where its bodies are, and what they look like.

Whoever draws computes nothing of the model. Places are in m, in a body's own frame unless said
otherwise; the body ``ground`` is the world.
"""

from typing import Literal

from pydantic import Field

from schemas.base import Strict

Numbers = list[float | None]
Point = list[float]
"""x and y of a planar mechanism; x, y and z in space."""


class PlanarPoses(Strict):
    """A body's origin in m and its angle in rad, counterclockwise, one for each time."""

    x: Numbers
    y: Numbers
    angle: Numbers


class SpatialPoses(Strict):
    """A body's origin in m and its unit quaternions (w, x, y, z), one for each time."""

    x: Numbers
    y: Numbers
    z: Numbers
    quaternion: list[Numbers]


class Arrow(Strict):
    """A contact's force on its body, N, at a place, both in the world; null while there is none."""

    x: Numbers
    y: Numbers
    fx: Numbers
    fy: Numbers


class SpatialArrow(Strict):
    """The same in space."""

    x: Numbers
    y: Numbers
    z: Numbers
    fx: Numbers
    fy: Numbers
    fz: Numbers


class Spot(Strict):
    """A place of a body."""

    body: str
    at: Point


class BodyLook(Strict):
    """How a body looks: its outline, or a link from the first of its ``places`` to the others.

    The first place is where its own joint holds it; ``com`` is null for a mere frame.
    """

    outline: list[Point] = Field(default_factory=list)
    places: list[Point] = Field(default_factory=list)
    com: Point | None = None


class JointLook(Spot):
    """A hinge, or the rail of a slider: from ``at`` to ``end``, in the frame of the parent.

    ``child`` is the body that it carries; a loop has none.
    """

    kind: Literal["revolute", "prismatic", "loop"]
    child: str | None = None
    end: Point | None = None


class ContactLook(Spot):
    """A contact point, or a circle about it."""

    radius: float = 0.0


class ShapeLook(Spot):
    """A circle or an ellipse of a body; ``axes`` are its half axes."""

    axes: Point


class Scene(Strict):
    """What does not change: bodies, joints, contacts, shapes by name, springs, fixed ground.

    ``springs`` have two ends; ``surfaces`` are lines in the world, free above them.
    """

    bodies: dict[str, BodyLook]
    joints: dict[str, JointLook] = Field(default_factory=dict)
    contacts: dict[str, ContactLook] = Field(default_factory=dict)
    shapes: dict[str, ShapeLook] = Field(default_factory=dict)
    springs: dict[str, list[Spot]] = Field(default_factory=dict)
    surfaces: dict[str, list[Point]] = Field(default_factory=dict)


class Frames(Strict):
    """A motion, densely enough to be animated; also at the knots, where it may bend."""

    time: list[float]
    bodies: dict[str, PlanarPoses | SpatialPoses]
    forces: dict[str, Arrow | SpatialArrow] = Field(default_factory=dict)
    scene: Scene
