"""Evaluate a tree over any arithmetic: the one recursion that every evaluator shares."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from schemas.expressions.tree import Name, Number, Tree

Value = TypeVar("Value")


def fold(
    tree: Tree,
    functions: Mapping[str, Callable[..., Value]],
    lookup: Callable[[Name], Value],
    number: Callable[[float], Any] = float,
) -> Value:
    """Evaluate ``tree``, leaves by ``lookup`` and ``number``, nodes by ``functions``.

    Recursion is safe: the parser caps the depth of every tree.
    """
    if isinstance(tree, Number):
        return number(tree.value)  # type: ignore[no-any-return]
    if isinstance(tree, Name):
        return lookup(tree)
    arguments = [fold(argument, functions, lookup, number) for argument in tree.arguments]
    return functions[tree.function](*arguments)
