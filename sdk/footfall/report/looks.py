"""What bodies look like, as paths in their own frames, in m: a browser and an SVG draw the same.

A body without an outline is a rod from the place where its joint holds it to each other place of
it; one without extent is a block (on a slider) or a disc, and nothing where it has no mass.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from footfall.report.figures import TOGETHER

Scene = Mapping[str, Any]
Point = Sequence[float]

_ROD = 0.04  # half the thickness of a rod over the typical length of a body
_TIP = 0.3  # of that, where a rod ends in a contact point
_BLOCK = (0.18, 0.11)
_DISC = 0.1


@dataclass(frozen=True)
class Piece:
    """One path that moves with a body. ``kind`` says how it is drawn, ``style`` its colour."""

    body: str
    kind: str
    path: str
    style: str = ""


def pieces(scene: Scene) -> list[Piece]:
    """All pieces of a scene, the hindmost first."""
    size = typical_length(scene)
    rod = _ROD * size
    return [
        *_rails(scene),
        *_bodies(scene, size),
        *_shapes(scene),
        *_contacts(scene, 0.4 * rod),
        *_coms(scene, 0.75 * rod),
        *_hinges(scene, 0.5 * rod),
    ]


def typical_length(scene: Scene) -> float:
    """The median extent of the bodies that have one, in m; 1 where none has."""
    bodies = scene["bodies"].values()
    found = sorted(length for body in bodies if (length := _extent(corners(body))) > 0)
    radii = [look["radius"] for look in scene["contacts"].values() if look["radius"] > 0]
    radii += [max(look["axes"]) for look in scene["shapes"].values()]
    found = found or sorted(2 * radius for radius in radii)
    return found[len(found) // 2] if found else 1.0


def corners(body: Mapping[str, Any]) -> list[Point]:
    """The points of a body that a view has to hold."""
    return [*body["outline"], *body["places"], *([body["com"]] if body["com"] else [])]


def styles(scene: Scene) -> dict[str, str]:
    """The colour of each body, as those of series."""
    return {name: f"s{index % TOGETHER}" for index, name in enumerate(scene["bodies"])}


def _rails(scene: Scene) -> Iterator[Piece]:
    for joint in scene["joints"].values():
        if joint["kind"] == "prismatic" and joint["end"]:
            yield Piece(joint["body"], "rail", _polyline([joint["at"], joint["end"]]))


def _bodies(scene: Scene, size: float) -> Iterator[Piece]:
    colours = styles(scene)
    slides = _sliding(scene)
    round_ones = {look["body"] for look in scene["contacts"].values() if look["radius"] > 0}
    round_ones |= {look["body"] for look in scene["shapes"].values()}
    tips = [(look["body"], look["at"]) for look in scene["contacts"].values()]
    for name, body in scene["bodies"].items():
        if len(body["outline"]) > 2:
            yield Piece(name, "body", _polyline(body["outline"]) + "Z", colours[name])
            continue
        for start, end in rods(body):
            first, last = (_ROD * size * (_TIP if (name, p) in tips else 1) for p in (start, end))
            path = _capsule(start, end, first, last)
            yield Piece(name, "body", path, colours[name])
        for path in _block(body, size, block=name in slides, bare=name in round_ones):
            yield Piece(name, "body", path, colours[name])


def _block(body: Mapping[str, Any], size: float, *, block: bool, bare: bool) -> Iterator[str]:
    """What stands for a body without extent; a mere frame, without mass, is not seen."""
    if rods(body) or bare or not body["places"] or not body["com"]:
        return
    centre = body["places"][0]
    if block:
        yield _box(centre, _BLOCK[0] * size, _BLOCK[1] * size)
    else:
        yield _circle(centre, _DISC * size)


def rods(body: Mapping[str, Any]) -> list[tuple[Point, Point]]:
    """From the first place to each other one; to the com where no rod leads past it.

    An outline of two points is a rod, too, and the only one.
    """
    if len(body["outline"]) == 2:
        return [(body["outline"][0], body["outline"][1])]
    if not body["places"]:
        return []
    first, *others = body["places"]
    found = [(first, other) for other in others if math.dist(first, other) > 0]
    com = body["com"]
    if com and math.dist(first, com) > 0 and not any(_on(com, rod) for rod in found):
        found.append((first, com))
    return found


def _on(point: Point, rod: tuple[Point, Point]) -> bool:
    start, end = rod
    way = math.dist(start, point) + math.dist(point, end)
    return way <= 1.01 * math.dist(start, end)


def _sliding(scene: Scene) -> set[str]:
    return {j["child"] for j in scene["joints"].values() if j["kind"] == "prismatic"}


def _shapes(scene: Scene) -> Iterator[Piece]:
    colours = styles(scene)
    for look in scene["shapes"].values():
        path = _ellipse(look["at"], *look["axes"])
        yield Piece(look["body"], "body", path, colours.get(look["body"], ""))


def _coms(scene: Scene, radius: float) -> Iterator[Piece]:
    for name, body in scene["bodies"].items():
        if body["com"]:
            yield Piece(name, "com", _circle(body["com"], radius))
            yield Piece(name, "ink", _quarters(body["com"], radius))


def _contacts(scene: Scene, radius: float) -> Iterator[Piece]:
    colours = styles(scene)
    for look in scene["contacts"].values():
        if look["radius"] > 0:
            path = _wheel(look["at"], look["radius"])
            yield Piece(look["body"], "body", path, colours.get(look["body"], ""))
        else:
            yield Piece(look["body"], "ink", _circle(look["at"], radius))


def _hinges(scene: Scene, radius: float) -> Iterator[Piece]:
    for joint in scene["joints"].values():
        if joint["kind"] != "prismatic":
            yield Piece(joint["body"], "hinge", _circle(joint["at"], radius))


def _extent(points: Sequence[Point]) -> float:
    return max((math.dist(a, b) for a in points for b in points), default=0.0)


def _polyline(points: Sequence[Point]) -> str:
    return "M" + "L".join(f"{x:.6g} {y:.6g}" for x, y in points)


def _circle(centre: Point, radius: float) -> str:
    return _ellipse(centre, radius, radius)


def _ellipse(centre: Point, a: float, b: float) -> str:
    x, y = centre
    arc = f"A{a:.6g} {b:.6g} 0 1 0 "
    return f"M{x + a:.6g} {y:.6g}{arc}{x - a:.6g} {y:.6g}{arc}{x + a:.6g} {y:.6g}Z"


def _wheel(centre: Point, radius: float) -> str:
    """A circle with a spoke, so that its turning is seen."""
    x, y = centre
    return _circle(centre, radius) + f"M{x:.6g} {y:.6g}L{x + radius:.6g} {y:.6g}"


def _quarters(centre: Point, radius: float) -> str:
    """Two opposite quarters of a circle: the sign of a centre of mass."""
    x, y, r = *centre, radius
    arc = f"A{r:.6g} {r:.6g} 0 0 1 "
    return (
        f"M{x:.6g} {y:.6g}L{x + r:.6g} {y:.6g}{arc}{x:.6g} {y + r:.6g}Z"
        f"M{x:.6g} {y:.6g}L{x - r:.6g} {y:.6g}{arc}{x:.6g} {y - r:.6g}Z"
    )


def _capsule(start: Point, end: Point, first: float, last: float) -> str:
    """A rod with round ends of two radii."""
    length = math.dist(start, end)
    across = ((start[1] - end[1]) / length, (end[0] - start[0]) / length)
    a, b, c, d = (
        f"{point[0] + side * across[0]:.6g} {point[1] + side * across[1]:.6g}"
        for point, side in ((start, first), (end, last), (end, -last), (start, -first))
    )
    begin, tip = (f"A{radius:.6g} {radius:.6g} 0 0 0 " for radius in (first, last))
    return f"M{a}L{b}{tip}{c}L{d}{begin}{a}Z"


def _box(centre: Point, a: float, b: float) -> str:
    x, y = centre
    return _polyline([(x - a, y - b), (x + a, y - b), (x + a, y + b), (x - a, y + b)]) + "Z"
