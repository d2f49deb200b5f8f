"""The typed tree of an expression: three kinds of node, and the table of functions.

Operators are functions with the names in ``OPERATORS``: an evaluator is one mapping from a
function's name to its implementation, and the completeness test holds all evaluators to it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Number:
    """A finite constant."""

    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A declared name, dotted names whole (``final.q1``). ``column`` counts from 1."""

    name: str
    column: int = 1


@dataclass(frozen=True, slots=True)
class Call:
    """A function or an operator applied to arguments. ``column`` counts from 1."""

    function: str
    arguments: tuple["Tree", ...]
    column: int = 1


Tree = Number | Name | Call

OPERATORS: Mapping[str, tuple[int, int | None]] = MappingProxyType(
    {"+": (2, None), "-": (2, 2), "*": (2, None), "/": (2, 2), "^": (2, 2), "neg": (1, 1)}
)
"""Operator -> least and most arguments (None: any number; long sums and products are flat)."""

FUNCTIONS: Mapping[str, tuple[int, int | None]] = MappingProxyType(
    {
        **dict.fromkeys(
            [
                *("sin", "cos", "tan", "asin", "acos", "atan"),
                *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
                *("exp", "log", "log10", "sqrt", "abs", "sign"),
            ],
            (1, 1),
        ),
        **dict.fromkeys(["atan2", "hypot"], (2, 2)),
        **dict.fromkeys(["min", "max"], (2, None)),
    }
)
"""Function that a user may write -> least and most arguments."""


def walk(tree: Tree) -> Iterator[Tree]:
    """Every node of the tree, parents first, arguments from left to right."""
    pending = [tree]
    while pending:
        node = pending.pop()
        yield node
        if isinstance(node, Call):
            pending.extend(reversed(node.arguments))


def depth(tree: Tree) -> int:
    """Levels of the tree; a leaf has one."""
    deepest, pending = 1, [(tree, 1)]
    while pending:
        node, level = pending.pop()
        deepest = max(deepest, level)
        if isinstance(node, Call):
            pending.extend((argument, level + 1) for argument in node.arguments)
    return deepest


def names_in(tree: Tree) -> list[Name]:
    """The names that the tree uses, in order of appearance, repeats included."""
    if isinstance(tree, Name):
        return [tree]
    found: list[Name] = []
    pending: list[Tree] = [tree]
    while pending:  # as ``walk`` does, in half of the time: problems are lowered by this
        node = pending.pop()
        if isinstance(node, Call):
            pending.extend(node.arguments[::-1])
        elif isinstance(node, Name):
            found.append(node)
    return found
