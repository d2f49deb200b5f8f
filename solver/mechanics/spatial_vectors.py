"""Vectors in three dimensions over trees, and constant rotations applied to them."""

from collections.abc import Sequence

from schemas.expressions import Expression, Name, Number, Tree
from schemas.urdf.algebra import IDENTITY, Matrix, Vector, transposed
from solver.mechanics.trees import ZERO, less, plus, times

Vec3 = tuple[Tree, Tree, Tree]
Mat3 = tuple[Vec3, Vec3, Vec3]

NOWHERE: Vec3 = (ZERO, ZERO, ZERO)
AXES = "xyz"


def constant(vector: Vector) -> Vec3:
    """Numbers as trees."""
    x, y, z = (Number(float(entry)) if entry else ZERO for entry in vector)
    return x, y, z


def written(vector: Sequence[Expression]) -> Vec3:
    """What a user wrote as x, y and z."""
    x, y, z = (entry.tree for entry in vector)
    return x, y, z


def named(prefix: str) -> Vec3:
    """The names of a vector's entries: ``PREFIXx`` and so on."""
    return Name(f"{prefix}x"), Name(f"{prefix}y"), Name(f"{prefix}z")


def total(*vectors: Vec3) -> Vec3:
    """The sum of vectors."""
    x, y, z = (plus(*entries) for entries in zip(*vectors, strict=True))
    return x, y, z


def apart(a: Vec3, b: Vec3) -> Vec3:
    """The difference of two vectors."""
    return less(a[0], b[0]), less(a[1], b[1]), less(a[2], b[2])


def scaled(size: Tree, a: Vec3) -> Vec3:
    """A vector times a number."""
    return times(size, a[0]), times(size, a[1]), times(size, a[2])


def dot(a: Vec3, b: Vec3) -> Tree:
    """The scalar product."""
    return plus(times(a[0], b[0]), times(a[1], b[1]), times(a[2], b[2]))


def cross(a: Vec3, b: Vec3) -> Vec3:
    """The vector product."""
    return (
        less(times(a[1], b[2]), times(a[2], b[1])),
        less(times(a[2], b[0]), times(a[0], b[2])),
        less(times(a[0], b[1]), times(a[1], b[0])),
    )


def applied(rows: Mat3, a: Vec3) -> Vec3:
    """A matrix of trees times a vector."""
    return dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)


def columns(rows: Mat3) -> Mat3:
    """The transposed matrix."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a, d, g), (b, e, h), (c, f, i)


def matrix(numbers: Matrix) -> Mat3:
    """A constant matrix."""
    return constant(numbers[0]), constant(numbers[1]), constant(numbers[2])


def turned(axes: Matrix, a: Vec3) -> Vec3:
    """A vector of a frame in the frame that its axes are given in; ``R a``."""
    return a if axes == IDENTITY else applied(matrix(axes), a)


def unturned(axes: Matrix, a: Vec3) -> Vec3:
    """The other way round; ``R' a``."""
    return turned(transposed(axes), a)
