"""Vectors and rotations as tuples of floats: what a text of numbers needs, without numpy."""

import math
from collections.abc import Sequence

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]

ZERO: Vector = (0.0, 0.0, 0.0)
IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NOTHING: Matrix = (ZERO, ZERO, ZERO)

_ROUNDING = 1e-15
"""Entries of rotations this small are rounding: a quarter turn has zeros."""


def rotation(rpy: Sequence[float]) -> Matrix:
    """Of roll, pitch and yaw about the fixed axes x, y, z: ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    (sr, cr), (sp, cp), (sy, cy) = ((_clean(math.sin(a)), _clean(math.cos(a))) for a in rpy)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def _clean(value: float) -> float:
    return 0.0 if abs(value) < _ROUNDING else value


def transposed(m: Matrix) -> Matrix:
    """Rows for columns."""
    (a, b, c), (d, e, f), (g, h, i) = m
    return (a, d, g), (b, e, h), (c, f, i)


def applied(m: Matrix, v: Vector) -> Vector:
    """The product of matrix and vector."""
    x, y, z = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in m)
    return x, y, z


def product(a: Matrix, b: Matrix) -> Matrix:
    """The product of two matrices."""
    x, y, z = (applied(a, column) for column in transposed(b))
    return transposed((x, y, z))


def added(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def scaled(size: float, a: Vector) -> Vector:
    """A vector times a number."""
    return size * a[0], size * a[1], size * a[2]


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def summed(a: Matrix, b: Matrix) -> Matrix:
    """The sum of two matrices."""
    x, y, z = (added(p, q) for p, q in zip(a, b, strict=True))
    return x, y, z


def similar(turn: Matrix, m: Matrix) -> Matrix:
    """A tensor in other axes, ``R m R'``."""
    return product(product(turn, m), transposed(turn))


def steiner(mass: float, lever: Vector) -> Matrix:
    """What a point mass adds to the inertia about the foot of its lever."""
    x, y, z = scaled(mass, lever)
    a, b, c = lever
    return (
        (y * b + z * c, -x * b, -x * c),
        (-x * b, x * a + z * c, -y * c),
        (-x * c, -y * c, x * a + y * b),
    )


def least_minors(m: Matrix) -> tuple[float, float, float]:
    """The least principal minors of order 1, 2 and 3 of a symmetric tensor.

    With none below zero it is positive semidefinite, with all above zero definite.
    """
    (a, d, e), (_, b, f), (_, _, c) = m
    pairs = a * b - d * d, a * c - e * e, b * c - f * f
    return min(a, b, c), min(pairs), dot(m[0], cross(m[1], m[2]))
