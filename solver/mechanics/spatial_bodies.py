"""Moving frames: one for every step of a joint, with the inertia that it carries.

Links that are welded to each other are one body. A frame's axes are those of its link, turned by
a constant where the axis of a hinge is none of x, y and z: so every turn is one in a plane.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from schemas.urdf import WORLD, Carriage, Link, Pose, Step, Urdf
from schemas.urdf.algebra import (
    IDENTITY,
    NOTHING,
    ZERO,
    Matrix,
    Vector,
    added,
    applied,
    cross,
    dot,
    product,
    scaled,
    similar,
    steiner,
    summed,
    transposed,
)

_ALIGNED = 1e-14


@dataclass(slots=True)
class Body:
    """A frame that moves in its parent by one step, and all that is welded to it.

    Attributes
    ----------
    pose
        Of the frame before the step, in the parent's frame.
    step
        Its axis is along x, y or z, in the frame's own axes.
    mass, moment, inertia
        kg; mass times com, kg m; about the frame's origin, kg m^2: in the frame's own axes.
    """

    name: str
    parent: str
    pose: Pose
    step: Step
    damping: float = 0.0
    mass: float = 0.0
    moment: Vector = ZERO
    inertia: Matrix = NOTHING

    def carry(self, link: Link, pose: Pose) -> None:
        """Weld a link to the body, with its frame at ``pose``."""
        com = added(pose.origin, applied(pose.axes, link.com))
        about = summed(similar(pose.axes, link.inertia), steiner(link.mass, com))
        self.mass += link.mass
        self.moment = added(self.moment, scaled(link.mass, com))
        self.inertia = summed(self.inertia, about)


@dataclass(slots=True)
class Bodies:
    """All moving frames, parents first; ``hosts`` tells where every link's frame is."""

    bodies: dict[str, Body] = field(default_factory=dict)
    hosts: dict[str, tuple[str, Pose]] = field(default_factory=lambda: {WORLD: (WORLD, Pose())})

    @classmethod
    def of(cls, system: Urdf) -> "Bodies":
        """Go through the tree, parents first."""
        self = cls()
        for one in system.carriages:
            self._hang(one)
            body, pose = self.hosts[one.link]
            if body != WORLD:
                self.bodies[body].carry(system.tree.links[one.link], pose)
        return self

    def _hang(self, one: Carriage) -> None:
        body, pose = self.hosts[one.parent]
        pose = composed(pose, one.pose)
        for number, step in enumerate(one.steps, start=1):
            name = one.link if number == len(one.steps) else f"{one.link}#{number}"
            turn = _aligning(step.axis)
            own = step._replace(axis=_snapped(applied(transposed(turn), step.axis)))
            before = composed(pose, Pose(axes=turn))
            self.bodies[name] = Body(name, body, before, own, one.damping)
            body, pose = name, Pose(axes=transposed(turn))
        self.hosts[one.link] = body, pose


def composed(outer: Pose, inner: Pose) -> Pose:
    """A frame in a frame in a frame."""
    origin = added(outer.origin, applied(outer.axes, inner.origin))
    if outer.axes == IDENTITY:
        return Pose(origin, inner.axes)
    return Pose(origin, product(outer.axes, inner.axes))


def _snapped(axis: Vector) -> Vector:
    x, y, z = (float(round(entry)) for entry in axis)
    return x, y, z


def _aligning(axis: Vector) -> Matrix:
    """Axes of which one is along ``axis``: as they are where one is already."""
    if max(abs(entry) for entry in axis) > 1 - _ALIGNED:
        return IDENTITY
    first = _across(axis)
    return transposed((first, cross(axis, first), axis))


def _across(axis: Vector) -> Vector:
    """A unit vector at right angles to another."""
    smallest = min(range(3), key=lambda index: abs(axis[index]))
    start: Sequence[float] = [1.0 if index == smallest else 0.0 for index in range(3)]
    raw = cross(axis, (start[0], start[1], start[2]))
    return scaled(dot(raw, raw) ** -0.5, raw)
