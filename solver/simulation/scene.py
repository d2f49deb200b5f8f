"""What a mechanism looks like: the parts of its drawing that do not change with time."""

from collections.abc import Iterator, Mapping
from typing import assert_never

import numpy as np

from schemas.frames import (
    BodyLook,
    ContactLook,
    JointLook,
    Point,
    Scene,
    ShapeLook,
    Spot,
)
from schemas.mechanisms import Floating, Link, Mechanism, Place, Prismatic, Revolute, Welded
from schemas.mechanisms.contacts import HEIGHT_NAME
from solver.numeric.tape import Array, Scope, record
from solver.simulation.constants import Constants

_POINTS = 2001
"""At which a surface that is not level is looked at; fewer are kept."""

_STRAY = 1e-4
"""How far a line may stray from its surface, over what it spans."""

Span = tuple[float, float]


def scene_of(
    mechanism: Mechanism, constants: Constants, travel: Mapping[str, Span], reach: Span
) -> Scene:
    """The scene of a motion.

    Parameters
    ----------
    travel
        Coordinate -> its least and largest value, for the rails of sliders.
    reach
        From which to which x surfaces are drawn, m.
    """
    places = {name: _places(mechanism, name) for name in mechanism.bodies}
    return Scene(
        bodies={name: _body(mechanism, name, places[name], constants) for name in places},
        joints=dict(_joints(mechanism, constants, travel)),
        contacts={
            name: ContactLook(
                body=one.body,
                at=point(constants.vector(one.at)),
                radius=constants.number(one.radius),
            )
            for name, one in mechanism.contacts.items()
        },
        shapes=dict(_shapes(mechanism, constants)),
        springs={
            name: [_spot(place, constants) for place in spring.between]
            for name, spring in mechanism.springs.items()
            if spring.between
        },
        surfaces=dict(_surfaces(mechanism, constants, reach)),
    )


def point(z: complex) -> Point:
    """A point of the plane, to nine digits."""
    return [float(f"{z.real:.9g}"), float(f"{z.imag:.9g}")]


def _body(mechanism: Mechanism, name: str, places: list[Place], constants: Constants) -> BodyLook:
    body = mechanism.bodies[name]
    com = constants.vector(body.com) if body.mass is not None else None
    vectors = [constants.vector(place.at) for place in places]
    if _floats(mechanism, name) and com is not None:
        vectors.insert(0, com)
    return BodyLook(
        outline=[[float(x) for x in corner] for corner in body.outline],
        places=[point(z) for z in dict.fromkeys(vectors)],
        com=None if com is None else point(com),
    )


def _places(mechanism: Mechanism, body: str) -> list[Place]:
    """Where a body is held or touched, the place of its own joint first."""
    joints = [joint for joint in mechanism.joints.values() if not isinstance(joint, Floating)]
    springs = [spring.between for spring in mechanism.springs.values() if spring.between]
    loops = [loop.between for loop in mechanism.loops.values()]
    found = [
        *(Place(body=body, at=joint.to) for joint in joints if joint.child == body),
        *(Place(body=body, at=joint.at) for joint in joints if joint.parent == body),
        *(place for ends in [*loops, *springs] for place in ends),
        *mechanism.contacts.values(),
        *mechanism.points.values(),
    ]
    return [place for place in found if place.body == body]


def _floats(mechanism: Mechanism, body: str) -> bool:
    joints = mechanism.joints.values()
    return any(isinstance(joint, Floating) and joint.child == body for joint in joints)


def _joints(
    mechanism: Mechanism, constants: Constants, travel: Mapping[str, Span]
) -> Iterator[tuple[str, JointLook]]:
    for link in mechanism.links:
        look = _joint(link, constants, travel)
        if look is not None:
            yield link.joint_name, look
    for name, loop in mechanism.loops.items():
        spot = _spot(loop.between[0], constants)
        yield name, JointLook(kind="loop", body=spot.body, at=spot.at)


def _joint(link: Link, constants: Constants, travel: Mapping[str, Span]) -> JointLook | None:
    """What is drawn of a joint; None: nothing."""
    joint = link.joint
    match joint:
        case Revolute():
            at = point(constants.vector(joint.at))
            return JointLook(kind="revolute", body=link.parent, child=link.body, at=at)
        case Prismatic():
            along, start = constants.unit(joint.axis), constants.vector(joint.at)
            low, high = travel[link.coordinates[0]]
            return JointLook(
                kind="prismatic",
                body=link.parent,
                child=link.body,
                at=point(start + low * along),
                end=point(start + high * along),
            )
        case Welded() | Floating():
            return None
        case _:
            assert_never(joint)


def _shapes(mechanism: Mechanism, constants: Constants) -> Iterator[tuple[str, ShapeLook]]:
    for name, shape in mechanism.shapes.items():
        axes = shape.ellipse or (shape.circle, shape.circle)
        sizes = [constants.number(axis) for axis in axes]
        at = point(constants.vector(shape.at))
        yield name, ShapeLook(body=shape.body, at=at, axes=sizes)


def _surfaces(
    mechanism: Mechanism, constants: Constants, reach: Span
) -> Iterator[tuple[str, list[Point]]]:
    """Those that something may touch, as lines in the world."""
    touched = {pair.against for pair in mechanism.touching.values()}
    across = np.linspace(*reach, _POINTS)
    for name, surface in mechanism.surfaces.items():
        if name not in touched:
            continue
        known = {word: one for word, one in constants.values.items() if word != HEIGHT_NAME}
        tape = record([surface.height.tree], Scope((HEIGHT_NAME,), known))
        height = np.broadcast_to(tape([across], across.shape)[0], across.shape)
        yield name, _line(across, np.asarray(height))


def _line(x: Array, y: Array) -> list[Point]:
    """The points of a line that is finite, without those that lie between their neighbours."""
    kept = np.isfinite(y)
    x, y = x[kept], y[kept]
    if len(x) < 2:
        return []
    bound = _STRAY * float(np.ptp(y)) + 1e-12
    rows = _simple(x, y, 0, len(x) - 1, bound)
    return [point(complex(x[row], y[row])) for row in [*rows, len(x) - 1]]


def _simple(x: Array, y: Array, first: int, last: int, bound: float) -> list[int]:
    """Rows from the first on, without the last, whose chords stay near (Douglas and Peucker)."""
    kept: list[int] = []
    pending = [(first, last)]
    while pending:
        a, b = pending.pop()
        off = np.abs(np.interp(x[a : b + 1], x[[a, b]], y[[a, b]]) - y[a : b + 1])
        far = a + int(np.argmax(off))
        if off.max() <= bound:
            kept.append(a)
        else:
            pending += [(far, b), (a, far)]
    return kept


def _spot(place: Place, constants: Constants) -> Spot:
    return Spot(body=place.body, at=point(constants.vector(place.at)))
