"""Four bars in a loop: whether they fold flat, where they may go on in two ways."""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

from schemas.expressions import Expression
from schemas.mechanisms.mechanism import Mechanism
from schemas.mechanisms.parts import GROUND, Loop, Revolute, Vector
from schemas.mechanisms.topology import Link

_BARS, _SAME = 4, 1e-6

Value = Callable[[Expression], float | None]


def change_points(mechanism: Mechanism, value: Value) -> Iterator[str]:
    """Loops of four bars whose shortest and longest are together as long as the other two.

    Parameters
    ----------
    value
        The number behind a constant; None where it is not known.
    """
    for name, loop in mechanism.loops.items():
        bars = _bars(mechanism, loop, value)
        if len(bars) == _BARS:
            shortest, *middle, longest = sorted(bars)
            total = sum(bars)
            if abs(shortest + longest - sum(middle)) <= _SAME * total:
                yield name


def _bars(mechanism: Mechanism, loop: Loop, value: Value) -> list[float]:
    """The lengths of the bars around a loop; none where it is not of hinges and numbers."""
    links = {link.body: link for link in mechanism.links}
    left, right = (list(_down(links, place.body, place.at)) for place in loop.between)
    while len(left) > 1 and len(right) > 1 and left[-2].body == right[-2].body:
        left, right = left[:-1], right[:-1]  # the bar that both sides hang on is the last
    hinges = [*left[:-1], *right[:-1]]
    if not all(isinstance(links[bar.body].joint, Revolute) for bar in hinges):
        return []
    ends = [(bar.above, bar.below) for bar in hinges] + [(left[-1].above, right[-1].above)]
    lengths = [_distance(first, second, value) for first, second in ends]
    return [] if None in lengths else [one for one in lengths if one is not None]


class _Bar(NamedTuple):
    """A body between two pins: the one that led here, and that of its own joint."""

    body: str
    above: Vector
    below: Vector


def _down(links: dict[str, Link], body: str, at: Vector) -> Iterator[_Bar]:
    """The bodies from a place down to the ground."""
    while body in links:
        joint = links[body].joint
        yield _Bar(body, at, getattr(joint, "to", at))
        body, at = links[body].parent, getattr(joint, "at", at)
    yield _Bar(GROUND, at, at)


def _distance(first: Vector, second: Vector, value: Value) -> float | None:
    sides = [(value(a), value(b)) for a, b in zip(first, second, strict=True)]
    apart = [a - b for a, b in sides if a is not None and b is not None]
    return math.hypot(*apart) if len(apart) == len(sides) else None
