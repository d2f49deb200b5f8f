"""The coordinates of a robot: each joint as a chain of simple steps, the base's one first.

The language's own reading of the tree, shared by all who work on a robot: no physics.
"""

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

from schemas.urdf.algebra import Vector, added, cross, dot, scaled
from schemas.urdf.robot import HINGES, Joint, Pose, Robot

WORLD = ""
"""The parent of the root."""
BASE = "base"
"""The prefix of the base's coordinates."""

Base = Literal["fixed", "planar", "floating"]
Kind = Literal["hinge", "slide", "ball"]

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
QUATERNION = ("qw", "qx", "qy", "qz")


class Step(NamedTuple):
    """A turn about an axis, a slide along one, or a free turn by a quaternion.

    ``axis`` is a unit vector of the frame before the step. The value of a hinge or a slide is
    ``factor * coordinate + offset``: of a joint that mimics, the coordinate of another one.
    """

    kind: Kind
    coordinates: tuple[str, ...]
    axis: Vector = X
    factor: float = 1.0
    offset: float = 0.0


class Carriage(NamedTuple):
    """A link and how it hangs on its parent: first ``pose``, then the steps, one by one."""

    link: str
    parent: str
    joint: str
    pose: Pose
    steps: tuple[Step, ...]
    damping: float = 0.0


def carriages(robot: Robot, base: Base) -> list[Carriage]:
    """Every link, parents first; the root hangs on the world by the steps of its base."""
    joints = {joint.name: joint for joint in robot.joints}
    root = Carriage(robot.root, WORLD, BASE, Pose(), _BASES[base])
    return [
        root,
        *(
            Carriage(one.child, one.parent, name, one.pose, _steps(one), one.damping)
            for name, one in joints.items()
        ),
    ]


def coordinates(found: list[Carriage]) -> list[str]:
    """Every coordinate once, in the order of the tree."""
    names = [name for one in found for step in one.steps for name in step.coordinates]
    return list(dict.fromkeys(names))


def _free(prefix: str) -> tuple[Step, ...]:
    slides = (
        Step("slide", (f"{prefix}.{n}",), axis) for n, axis in zip("xyz", (X, Y, Z), strict=True)
    )
    return (*slides, Step("ball", tuple(f"{prefix}.{name}" for name in QUATERNION)))


def _steps(joint: Joint) -> tuple[Step, ...]:
    name, axis = joint.name, joint.axis
    if joint.mimic is not None:
        led = joint.mimic
        kind: Kind = "hinge" if joint.kind in HINGES else "slide"
        return (Step(kind, (led.joint,), axis, led.multiplier, led.offset),)
    if joint.kind in HINGES:
        return (Step("hinge", (name,), axis),)
    if joint.kind == "prismatic":
        return (Step("slide", (name,), axis),)
    if joint.kind == "floating":
        return _free(name)
    if joint.kind == "planar":
        first, second = _plane(axis)
        return (
            Step("slide", (f"{name}.u",), first),
            Step("slide", (f"{name}.v",), second),
            Step("hinge", (f"{name}.angle",), axis),
        )
    return ()


def _plane(normal: Vector) -> tuple[Vector, Vector]:
    """Two axes of the plane across ``normal``: of z they are x and y, of x y and z, and so on."""
    largest = max(range(3), key=lambda index: abs(normal[index]))
    start = (X, Y, Z)[(largest + 1) % 3]
    across = added(start, scaled(-dot(start, normal), normal))
    first = scaled(1 / math.sqrt(dot(across, across)), across)
    return first, cross(normal, first)


_BASES: Mapping[Base, tuple[Step, ...]] = {
    "fixed": (),
    "planar": (
        Step("slide", (f"{BASE}.x",), X),
        Step("slide", (f"{BASE}.z",), Z),
        Step("hinge", (f"{BASE}.pitch",), Y),
    ),
    "floating": _free(BASE),
}
