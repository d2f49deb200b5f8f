"""What contacts touch: a surface or a shape as one function F(x, y) that is zero on it.

F is positive outside. The gap is ``F / |grad F| - radius``, the Euclidean distance to first order
(exact for level ground and for circles); the normal is ``grad F / |grad F|``. The slopes are
those of differentiated trees.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.expressions import Call, Name, Number, Tree
from schemas.expressions.differentiation import ONE, total_derivative
from schemas.mechanisms import Shape, Surface
from schemas.mechanisms.contacts import HEIGHT_NAME
from solver.numeric.tape import Array, Scope, Tape, record
from solver.simulation.constants import Constants

Complex = NDArray[np.complex128]

X, Y = Name(HEIGHT_NAME), Name("y")
SERIES = ("gap", "gap_x", "gap_y", "gap_xx", "gap_xy", "gap_yy", "F_x", "F_y", "turn_x", "turn_y")
"""What an outline computes at a point."""


@dataclass(frozen=True, slots=True)
class Nearness:
    """How near a point is: at any number of points, each attribute of their shape.

    Attributes
    ----------
    gap
        From the outline to the point, without any radius, m.
    slope, curvature
        Its gradient (x, y), and second derivatives (xx, xy, yy).
    normal
        Unit vector away from the outline, complex.
    turning
        d(angle of the normal)/dx and /dy, rad/m.
    """

    gap: Array
    slope: tuple[Array, Array]
    curvature: tuple[Array, Array, Array]
    normal: Complex
    turning: tuple[Array, Array]

    @classmethod
    def of(cls, values: Array) -> "Nearness":
        """From the ``SERIES``."""
        gap, gap_x, gap_y, xx, xy, yy, fx, fy, turn_x, turn_y = values
        normal = (fx + 1j * fy) / np.hypot(fx, fy)
        return cls(gap, (gap_x, gap_y), (xx, xy, yy), normal, (turn_x, turn_y))


@dataclass(frozen=True, slots=True)
class Outline:
    """A surface, in the world's frame, or a shape, in that of its own centre."""

    tape: Tape

    @classmethod
    def surface(cls, surface: Surface, constants: Constants) -> "Outline":
        """Ground of a height over x."""
        return cls.zero_of(Call("-", (Y, surface.height.tree)), constants)

    @classmethod
    def shape(cls, shape: Shape, constants: Constants) -> "Outline":
        """A circle or an ellipse about the origin."""
        if shape.circle is not None:
            radius = constants.number(shape.circle)
            return cls.zero_of(Call("-", (Call("hypot", (X, Y)), Number(radius))), constants)
        a, b = (constants.number(axis) for axis in shape.ellipse or [])
        sides = Call("/", (X, Number(a))), Call("/", (Y, Number(b)))
        return cls.zero_of(Call("-", (Call("hypot", sides), ONE)), constants)

    @classmethod
    def zero_of(cls, tree: Tree, constants: Constants) -> "Outline":
        """The outline on which a tree over x and y is zero."""
        fx, fy = _slope(tree, "x"), _slope(tree, "y")
        gap = Call("/", (tree, Call("hypot", (fx, fy))))
        gap_x, gap_y = _slope(gap, "x"), _slope(gap, "y")
        square = Call("+", (Call("*", (fx, fx)), Call("*", (fy, fy))))
        turns = [_turn(fx, fy, name, square) for name in ("x", "y")]
        trees: Sequence[Tree] = (
            *(gap, gap_x, gap_y),
            *(_slope(gap_x, "x"), _slope(gap_x, "y"), _slope(gap_y, "y")),
            *(fx, fy, *turns),
        )
        known = {name: one for name, one in constants.values.items() if name not in ("x", "y")}
        return cls(record(trees, Scope(("x", "y"), known)))

    def __call__(self, z: Complex) -> Array:
        """The ``SERIES`` at points given as complex numbers of any shape."""
        return self.tape([z.real, z.imag], z.shape)


def _slope(tree: Tree, name: str) -> Tree:
    return total_derivative(tree, lambda one: ONE if one == name else None)


def _turn(fx: Tree, fy: Tree, name: str, square: Tree) -> Tree:
    """The slope of atan2(fy, fx)."""
    ahead = Call("*", (fx, _slope(fy, name)))
    back = Call("*", (fy, _slope(fx, name)))
    return Call("/", (Call("-", (ahead, back)), square))
