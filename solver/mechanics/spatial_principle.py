"""What the balance of momentum over a finite step is made of, in space.

A body moves as its centre does, from place to place, and turns by one angle about one axis. The
places are those of the plane with one coordinate more; the turning is `solver.discrete.spins`'s. A
quaternion's norm enters neither; it is kept at 1 by a row, and what would push along it is left
out (``Principle.norms``).
"""

from collections.abc import Iterator, Mapping

import numpy as np

from schemas.expressions import Name, Number, Tree, derivative
from schemas.urdf import Urdf, motor_torque
from solver.mechanics.principle import Inert, Principle, Push, Spin
from solver.mechanics.sliding import Slide
from solver.mechanics.spatial_bodies import Body
from solver.mechanics.spatial_contacts import SpatialTouch, spatial_touches
from solver.mechanics.spatial_motion import Motions
from solver.mechanics.spatial_series import series
from solver.mechanics.spatial_vectors import Vec3, constant, scaled, total, turned, written
from solver.mechanics.trees import ONE, ZERO, minus, times

_HALF = Number(0.5)


def spatial_principle(system: Urdf) -> Principle:
    """The balance of a checked system whose contacts may all touch and slide."""
    motions = Motions.of(system)
    touches = spatial_touches(motions)
    bodies = [one for one in motions.bodies.bodies.values() if _inert(one)]
    definitions = series(motions, touches) | motions.trees
    return Principle(
        tuple(system.coordinates),
        tuple(system.control_names),
        definitions | {name: one.tree for name, one in system.define.items()},
        written(system.gravity),
        tuple(_centre(motions, body) for body in bodies if body.mass),
        (*_drives(motions), *_forces(motions), *_normals(touches)),
        (),
        tuple(slide for touch in touches.values() for slide in _slides(motions, touch)),
        tuple(_spin(motions, body) for body in bodies),
        tuple(_norms(system)),
        tuple(_hinges(motions).items()),
    )


def _inert(body: Body) -> bool:
    return bool(body.mass) or any(any(row) for row in body.inertia)


def _centre(motions: Motions, body: Body) -> Inert:
    lever = scaled(Number(1 / body.mass), constant(body.moment))
    place = total(motions.origins[body.name], motions.world(body.name, lever))
    return Inert(body.name, Number(body.mass), ZERO, place, ZERO)


def _spin(motions: Motions, body: Body) -> Spin:
    inertia = np.array(body.inertia)
    if body.mass:
        lever = np.array(body.moment) / body.mass
        inertia -= body.mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    first, second, third = ((row[0], row[1], row[2]) for row in inertia.tolist())
    return Spin(motions.axes[body.name], (first, second, third))


def _drives(motions: Motions) -> Iterator[Push]:
    """Motors, the damping of joints, and stops that push."""
    system = motions.system
    for joint in system.motor_joints:
        yield Push(f"motor.{joint}", Name(joint), Name(motor_torque(joint)))
    for body in motions.bodies.bodies.values():
        step = body.step
        if body.damping:
            name = step.coordinates[0]
            size = Number(-body.damping * step.factor**2)
            yield Push(f"damping.{body.name}", Name(name), times(size, Name(derivative(name))))
    for name in system.coordinates:
        if f"limit.{name}" in system.define:
            yield Push(f"limit.{name}", Name(name), Name(f"limit.{name}"))


def _forces(motions: Motions) -> Iterator[Push]:
    """The user's forces, by their components in the world."""
    for name, one in motions.system.forces.items():
        body, pose = motions.bodies.hosts[one.link]
        along = written(one.direction)
        if one.frame == "link":
            along = motions.world(body, turned(pose.axes, along))
        at = motions.place((body, pose), written(one.at))
        place = total(motions.origins[body], motions.world(body, at))
        for word, moved, push in zip("xyz", place, scaled(one.value.tree, along), strict=True):
            yield Push(f"force.{name}.{word}", moved, push)


def _normals(touches: Mapping[str, SpatialTouch]) -> Iterator[Push]:
    for touch in touches.values():
        yield Push(touch.word("gap"), Name(touch.word("gap")), Name(touch.word("normal")))


def _slides(motions: Motions, touch: SpatialTouch) -> Iterator[Slide]:
    """How the matter of a contact moves along x and y: its centre, and what a sphere rolls.

    Half the sum of ``e_k x de_k`` over the axes of a body, with their means, is the axis of its
    turn over a step times the sine of the angle.
    """
    place = total(motions.origins[touch.body], motions.world(touch.body, touch.centre))
    x, y, z = motions.axes[touch.body]
    entries = (*x, *y, *z) if touch.radius != ZERO else ()
    for word, moved, along in zip("xy", place, (x, y), strict=False):
        rolled = tuple(one for one in _rolled(touch.radius, along, z) if ZERO not in one)
        effort = Name(touch.word(f"tangential_{word}"))
        yield Slide(touch.name, effort, ((ONE, moved),), f"_{word}", rolled, entries)


def _rolled(radius: Tree, along: Vec3, up: Vec3) -> list[tuple[Tree, Tree]]:
    """``-r/2 (up . d along - along . d up)``: by rows of the rotation, x and z or y and z."""
    half = times(_HALF, radius)
    forward = [(minus(times(half, b)), a) for a, b in zip(along, up, strict=True)]
    return forward + [(times(half, a), b) for a, b in zip(along, up, strict=True)]


def _norms(system: Urdf) -> Iterator[tuple[int, ...]]:
    for first in system.balls:
        start = system.coordinates.index(first)
        yield tuple(range(start, start + 4))


def _hinges(motions: Motions) -> dict[int, float]:
    """Coordinates of hinges, with the factor of that which turns most."""
    found: dict[int, float] = {}
    for body in motions.bodies.bodies.values():
        if body.step.kind == "hinge":
            place = motions.system.coordinates.index(body.step.coordinates[0])
            found[place] = max(found.get(place, 0.0), abs(body.step.factor))
    return found
