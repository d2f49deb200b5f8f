"""DirCol5i: quintic Hermite splines for implicit second-order systems (003, sections 8.4, 8.12)."""

from collections.abc import Sequence
from math import factorial
from typing import Any

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.mesh.polynomials import from_powers
from solver.transcriptions.base import Array, Collocation, Node, Point, Segment, Transcription

_INNER = np.sqrt(5.0) / 10.0
_LEFT, _RIGHT = 0.5 - _INNER, 0.5 + _INNER


class DirCol5i(Transcription):
    """Positions are quintic splines with two continuous derivatives, controls cubic with one.

    The knots carry position, velocity and acceleration, control and control rate. The dynamics
    hold, as they are written, at the four Gauss-Lobatto points of each segment, where integrals
    are summed up too (8.15, 8.17); higher derivatives are those of the splines.

    The quintic of the seed follows from both its knots, and its fourth derivative is a difference
    of positions over h^4: round-off, and curvatures of the objective over h^8, end that on short
    segments. Here jerk and snap of each segment are variables of their own, the quintic is its
    Taylor series from the first knot, and to arrive at the second one is the defect. It is the
    same spline, by equations that stay well conditioned.
    """

    order = 6
    error_order = 5
    native = True
    nodes = (
        Node(0.0),
        Node(_LEFT, state=False, control=False, native=(3, 4)),
        Node(_RIGHT, state=False, control=False, native=(4,)),
        Node(1.0),
    )
    weights = (1 / 12, 5 / 12, 5 / 12, 1 / 12)

    def collocate(self, segment: Segment) -> Collocation:
        """The splines at the four points; the dynamics are constraints along the phase."""
        a, left, right, b = segment.points
        h = segment.h
        position = [*_split(a.x, 3), *_higher(left.natives, right.natives, h)]
        ends = _split(a.u, 2), _split(b.u, 2)
        control = [power * factorial(k) / h**k for k, power in enumerate(_cubic(*ends, h))]
        points = tuple(
            _at(node, point, position, control, h)
            for node, point in zip(self.nodes, segment.points, strict=True)
        )
        defects = ca.vertcat(*(_taylor(position, order, h) for order in range(3))) - b.x
        return Collocation(points, defects, self.weighted(points), _hull(*ends, h))

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """The splines, their first and their second derivatives."""
        del f
        start, end = (np.split(x[:, node], 3, axis=1) for node in (0, 3))
        powers = _quintic(start, end, h)
        slopes = [
            [p * k / h for k, p in enumerate(powers)][1:],
            [p * k * (k - 1) / h**2 for k, p in enumerate(powers)][2:],
        ]
        rows = [
            powers,
            *([*some, *[np.zeros_like(powers[0])] * (6 - len(some))] for some in slopes),
        ]
        return from_powers(np.concatenate([np.stack(row, axis=1) for row in rows], axis=2))

    def control_curve(self, u: Array, h: Array) -> Array:
        """The splines and their first derivatives."""
        start, end = (np.split(u[:, node], 2, axis=1) for node in (0, 3))
        powers = _cubic(start, end, h)
        rates = [*([p * k / h for k, p in enumerate(powers)][1:]), np.zeros_like(powers[0])]
        return from_powers(
            np.concatenate([np.stack(row, axis=1) for row in (powers, rates)], axis=2)
        )


def _higher(left: SX, right: SX, h: SX) -> list[SX]:
    """Third to fifth derivatives at the segment's start, from those at its inner points."""
    (jerk, snap), last = _split(left, 2), right
    slope = (last - snap) / ((_RIGHT - _LEFT) * h)
    start = snap - slope * (_LEFT * h)
    return [jerk - start * (_LEFT * h) - slope * (_LEFT * h) ** 2 / 2, start, slope]


def _at(node: Node, point: Point, position: Sequence[SX], control: Sequence[SX], h: SX) -> Point:
    """The splines and their derivatives at a node."""
    s = node.fraction * h
    q, v, a, jerk, snap = (_taylor(position, k, s) for k in range(5))
    u, rate, curvature = (_taylor(control, k, s) for k in range(3))
    knot = node.state
    return Point(
        point.x if knot else ca.vertcat(q, v, a),
        point.u if knot else ca.vertcat(u, rate),
        point.z,
        point.t,
        ca.vertcat(jerk, snap, curvature),
    )


def _taylor(derivatives: Sequence[SX], order: int, s: SX) -> SX:
    """A derivative of a polynomial a time s after the point where all of its own are given."""
    total = SX(0)
    for k, term in enumerate(derivatives[order:]):
        total = total + term * (s**k / factorial(k))
    return total


def _quintic(start: Sequence[Any], end: Sequence[Any], h: Any) -> list[Any]:
    """Coefficients in s of the quintic with these values, slopes and curvatures (8.12)."""
    (q0, v0, a0), (q1, v1, a1) = start, end
    c0, c1, c2 = q0, h * v0, h**2 * a0 / 2
    gap, slope, bend = q1 - c0 - c1 - c2, h * v1 - c1 - 2 * c2, h**2 * a1 - 2 * c2
    return [
        c0,
        c1,
        c2,
        10 * gap - 4 * slope + bend / 2,
        -15 * gap + 7 * slope - bend,
        6 * gap - 3 * slope + bend / 2,
    ]


def _cubic(start: Sequence[Any], end: Sequence[Any], h: Any) -> list[Any]:
    """Coefficients in s of the cubic with these values and slopes."""
    (u0, r0), (u1, r1) = start, end
    rise = u1 - u0
    return [u0, h * r0, 3 * rise - h * (2 * r0 + r1), h * (r0 + r1) - 2 * rise]


def _hull(start: Sequence[SX], end: Sequence[SX], h: SX) -> tuple[SX, ...]:
    """The inner Bernstein coefficients of the control and of its rate.

    A polynomial lies within the range of its Bernstein coefficients: where these keep their
    bounds, a cubic that saturates does not pass them between the points.
    """
    (u0, r0), (u1, r1) = start, end
    first, second = u0 + h * r0 / 3, u1 - h * r1 / 3
    middle = 3 * (second - first) / h
    return ca.vertcat(first, middle), ca.vertcat(second, middle)


def _split(stacked: SX, parts: int) -> list[SX]:
    """A vector in equal parts: values, then their derivatives."""
    count = stacked.numel() // parts
    return [stacked[k * count : (k + 1) * count] for k in range(parts)]
