"""Typed trees into CasADi: one mapping from a function's name to its symbolic form."""

import functools
from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca

from schemas.expressions import Name, Tree, fold

SX = ca.SX


# By the operation's own number: an operator of CasADi's Python classes tries one kind of argument
# after the other, for ten times as long.


def _unary(operation: int) -> Callable[[Any], Any]:
    return functools.partial(SX.unary, operation)


def _binary(operation: int) -> Callable[[Any, Any], Any]:
    return functools.partial(SX.binary, operation)


def _many(operation: int) -> Callable[..., Any]:
    def together(first: Any, *rest: Any) -> Any:
        for one in rest:
            first = SX.binary(operation, first, one)
        return first

    return together


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "+": _many(ca.OP_ADD),
    "-": _binary(ca.OP_SUB),
    "*": _many(ca.OP_MUL),
    "/": _binary(ca.OP_DIV),
    "^": _binary(ca.OP_POW),
    "neg": _unary(ca.OP_NEG),
    "sin": _unary(ca.OP_SIN),
    "cos": _unary(ca.OP_COS),
    "tan": _unary(ca.OP_TAN),
    "asin": _unary(ca.OP_ASIN),
    "acos": _unary(ca.OP_ACOS),
    "atan": _unary(ca.OP_ATAN),
    "sinh": _unary(ca.OP_SINH),
    "cosh": _unary(ca.OP_COSH),
    "tanh": _unary(ca.OP_TANH),
    "asinh": _unary(ca.OP_ASINH),
    "acosh": _unary(ca.OP_ACOSH),
    "atanh": _unary(ca.OP_ATANH),
    "exp": _unary(ca.OP_EXP),
    "log": _unary(ca.OP_LOG),
    "log10": ca.log10,
    "sqrt": _unary(ca.OP_SQRT),
    "abs": _unary(ca.OP_FABS),
    "sign": _unary(ca.OP_SIGN),
    "atan2": _binary(ca.OP_ATAN2),
    "hypot": lambda a, b: ca.sqrt(a * a + b * b),
    "min": _many(ca.OP_FMIN),
    "max": _many(ca.OP_FMAX),
}
"""Every operator and function of the language (``schemas.expressions.tree``)."""


def evaluate(tree: Tree, scope: Mapping[str, SX]) -> SX:
    """The tree as a scalar CasADi expression over the symbols of ``scope``."""

    def lookup(name: Name) -> SX:
        return scope[name.name]

    value = fold(tree, FUNCTIONS, lookup)
    return value if isinstance(value, SX) else SX(value)


def scalars(vector: SX) -> list[SX]:
    """The elements one by one: far faster than an index at a time."""
    return vector.elements()  # type: ignore[return-value]  # Python gets them as scalar SX
