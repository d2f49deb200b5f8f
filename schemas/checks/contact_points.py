"""Contact points of rigid bodies: those that are one place, and those too many to bear a load."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from schemas.checks.masses import Numbers
from schemas.errors import Issue
from schemas.expressions import Expression, ExpressionError, constant
from schemas.mechanisms import GROUND, Mechanism, Surface, Welded
from schemas.mechanisms.contacts import HEIGHT_NAME
from schemas.urdf import Urdf

_SAME = 1e-9
_STRAIGHT = 1e-6
_FEW = 12
_SAMPLES = (-1.3, 0.4, 2.9)
"""Places, m, at which the heights of straight ground lie on one line."""

Vector = tuple[float, ...]


class Point(NamedTuple):
    """A contact in the frame of the rigid body that carries it."""

    name: str
    body: str
    at: Vector
    radius: float


class _Frame(NamedTuple):
    """A body's frame in that of the body that it is welded to in the end."""

    body: str
    x: float
    y: float
    angle: float

    def place(self, x: float, y: float) -> tuple[float, float]:
        """A place of the body's frame, in the other one."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return self.x + c * x - s * y, self.y + s * x + c * y


def coincident(system: Mechanism | Urdf, numbers: Numbers) -> Iterator[Issue]:
    """An issue for every contact at the place of another one that may touch the same."""
    for against, points in _against(system, numbers):
        told: set[str] = set()
        for one, two in combinations(points, 2):
            if two.name in told or not _alike(one, two):
                continue
            told.add(two.name)
            yield Issue(
                numbers.at("contacts", two.name),
                f"'{one.name}' and '{two.name}' are the same place of '{one.body}', and both may "
                f"touch '{against}': nothing tells their forces apart",
                "keep one of them",
            )


def redundant(system: Mechanism | Urdf, numbers: Numbers) -> Iterator[tuple[str, str, list[str]]]:
    """Ground, body, and contacts of it that bear a load in more than one way."""
    for against, points in _against(system, numbers):
        if isinstance(system, Mechanism):
            surface = system.surfaces.get(against)
            if surface is None or not _straight(surface, numbers):
                continue
        for body in dict.fromkeys(point.body for point in points):
            own = [point for point in points if point.body == body]
            found = next((some for some in _groups(own, system) if _flat(some)), None)
            if found is not None:
                yield against, body, [point.name for point in found]


def _groups(points: Sequence[Point], system: Mechanism | Urdf) -> Iterator[tuple[Point, ...]]:
    """Three points of one radius; in space four, too, of the first few."""
    for radius in dict.fromkeys(point.radius for point in points):
        alike = [point for point in points if point.radius == radius][:_FEW]
        yield from combinations(alike, 3)
        if isinstance(system, Urdf):
            yield from combinations(alike, 4)


def _against(system: Mechanism | Urdf, numbers: Numbers) -> Iterator[tuple[str, list[Point]]]:
    """What may be touched, and the points that may touch it."""
    if isinstance(system, Urdf):
        yield "ground", list(_spatial(system, numbers))
        return
    frames = _frames(system, numbers)
    points = {point.name: point for point in _planar(system, numbers, frames)}
    for against in (*system.surfaces, *system.shapes):
        named = dict.fromkeys(
            pair.contact for pair in system.touching.values() if pair.against == against
        )
        yield against, [points[name] for name in named if name in points]


def _planar(system: Mechanism, numbers: Numbers, frames: dict[str, _Frame]) -> Iterator[Point]:
    for name, contact in system.contacts.items():
        at, frame = _values(contact.at, numbers), frames.get(contact.body)
        radius = numbers.value(contact.radius)
        if frame is not None and at is not None and radius is not None:
            yield Point(name, frame.body, frame.place(at[0], at[1]), radius)


def _spatial(system: Urdf, numbers: Numbers) -> Iterator[Point]:
    for name, contact in system.contacts.items():
        at, radius = _values(contact.at, numbers), numbers.value(contact.radius)
        if at is not None and radius is not None:
            yield Point(name, contact.link, at, radius)


def _frames(system: Mechanism, numbers: Numbers) -> dict[str, _Frame]:
    """Every body of which the place on a rigid one is known."""
    found = {GROUND: _Frame(GROUND, 0.0, 0.0, 0.0)}
    for link in system.links:
        if not isinstance(link.joint, Welded):
            found[link.body] = _Frame(link.body, 0.0, 0.0, 0.0)
            continue
        joint, parent = link.joint, found.get(link.parent)
        at, to = _values(joint.at, numbers), _values(joint.to, numbers)
        angle = numbers.value(joint.angle)
        if parent is None or at is None or to is None or angle is None:
            continue
        turn = parent.angle + angle
        foot = _Frame(parent.body, *parent.place(at[0], at[1]), turn)
        found[link.body] = _Frame(parent.body, *foot.place(-to[0], -to[1]), turn)
    return found


def _values(vector: Sequence[Expression], numbers: Numbers) -> Vector | None:
    values = [numbers.value(one) for one in vector]
    known = tuple(value for value in values if value is not None and math.isfinite(value))
    return known if len(known) == len(values) else None


def _alike(one: Point, two: Point) -> bool:
    size = 1 + max(map(abs, one.at))
    return (
        one.body == two.body
        and math.dist(one.at, two.at) <= _SAME * size
        and abs(one.radius - two.radius) <= _SAME * size
    )


def _flat(points: Sequence[Point]) -> bool:
    """Whether three points lie on one line, or four on one plane, and no two at one place."""
    first, *rest = (point.at for point in points)
    arms = [tuple(b - a for a, b in zip(first, one, strict=True)) for one in rest]
    size = math.prod(math.hypot(*arm) for arm in arms)
    return size > 0 and _volume(arms) <= _STRAIGHT * size


def _volume(arms: Sequence[Vector]) -> float:
    """Of the parallelogram or the block that two or three arms span."""
    grown: list[list[float]] = []
    volume = 1.0
    for arm in arms:
        left = list(arm)
        for one in grown:
            along = math.fsum(a * b for a, b in zip(left, one, strict=True))
            left = [a - along * b for a, b in zip(left, one, strict=True)]
        length = math.hypot(*left)
        volume *= length
        grown.append([a / length for a in left] if length else left)
    return volume


def _straight(surface: Surface, numbers: Numbers) -> bool:
    """Whether a ground is level or a ramp; no, where its height is not known."""
    try:
        a, b, c = (
            constant(surface.height.tree, {**numbers.known, HEIGHT_NAME: x}) for x in _SAMPLES
        )
    except ExpressionError:
        return False
    x, y, z = _SAMPLES
    return abs((b - a) * (z - x) - (c - a) * (y - x)) <= _STRAIGHT * (1 + abs(a) + abs(c))
