"""Smooth functions in place of ``abs``, ``min`` and ``max``.

Sources: 003, equation 7.57 (tanh); 004, equation 12 (the square root, 0 at 0); ``max(a, b)`` is
``(a + b + abs(a - b)) / 2``.
"""

from collections.abc import Callable, Mapping, Sequence

from schemas.expressions.tree import Call, Number, Tree, names_in

Smooth = Callable[[Tree, float, int], Tree]
"""An argument, the width of the smoothing and the column to the smooth absolute value."""

NONSMOOTH = frozenset({"abs", "min", "max"})


def _tanh(tree: Tree, width: float, column: int) -> Tree:
    ratio = Call("/", (tree, Number(width)), column)
    return Call("*", (tree, Call("tanh", (ratio,), column)), column)


def _sqrt(tree: Tree, width: float, column: int) -> Tree:
    square = Call("^", (tree, Number(2.0)), column)
    root = Call("sqrt", (Call("+", (square, Number(width**2)), column),), column)
    return Call("-", (root, Number(width)), column)


SMOOTH: Mapping[str, Smooth] = {"tanh": _tanh, "sqrt": _sqrt}
"""The ways to smooth, by the names of ``schemas.problem.Smoothing``."""


def smooth(tree: Tree, absolute: Callable[[Tree, int], Tree], fixed: Callable[[str], bool]) -> Tree:
    """``tree`` with ``absolute`` (argument and column) for abs, and min and max by means of it.

    What only ``fixed`` names, constants, are in stays as it is.
    """
    if not isinstance(tree, Call) or not any(not fixed(name.name) for name in names_in(tree)):
        return tree
    arguments = tuple(smooth(one, absolute, fixed) for one in tree.arguments)
    if tree.function == "abs":
        return absolute(arguments[0], tree.column)
    if tree.function in ("min", "max"):
        return _extreme(tree.function, arguments, tree.column, absolute)
    return Call(tree.function, arguments, tree.column)


def _extreme(
    function: str,
    arguments: Sequence[Tree],
    column: int,
    absolute: Callable[[Tree, int], Tree],
) -> Tree:
    """By halves: each repeats its arguments, so that a chain would double with every one."""
    if len(arguments) == 1:
        return arguments[0]
    middle = len(arguments) // 2
    a = _extreme(function, arguments[:middle], column, absolute)
    b = _extreme(function, arguments[middle:], column, absolute)
    gap = absolute(Call("-", (a, b), column), column)
    side = gap if function == "max" else Call("neg", (gap,), column)
    return Call("*", (Number(0.5), Call("+", (a, b, side), column)), column)


def smoothed_size(tree: Tree) -> int:
    """How many nodes the smooth form has at the most, without making it."""
    if not isinstance(tree, Call):
        return 1
    sizes = [smoothed_size(one) for one in tree.arguments]
    if tree.function == "abs":
        return _absolute_size(sizes[0])
    return _extreme_size(sizes) if tree.function in ("min", "max") else 1 + sum(sizes)


def _absolute_size(argument: int) -> int:
    return 2 * argument + 4


def _extreme_size(sizes: Sequence[int]) -> int:
    if len(sizes) == 1:
        return sizes[0]
    middle = len(sizes) // 2
    a, b = _extreme_size(sizes[:middle]), _extreme_size(sizes[middle:])
    return a + b + _absolute_size(1 + a + b) + 4
