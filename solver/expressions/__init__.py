"""Typed trees into CasADi: one mapping from a function's name to its symbolic form."""

import functools
from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca

from schemas.expressions import Name, Tree, fold

SX = ca.SX


def _sum(*terms: Any) -> Any:
    return functools.reduce(lambda a, b: a + b, terms)


def _product(*factors: Any) -> Any:
    return functools.reduce(lambda a, b: a * b, factors)


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "+": _sum,
    "-": lambda a, b: a - b,
    "*": _product,
    "/": lambda a, b: a / b,
    "^": ca.power,
    "neg": lambda a: -a,
    "sin": ca.sin,
    "cos": ca.cos,
    "tan": ca.tan,
    "asin": ca.asin,
    "acos": ca.acos,
    "atan": ca.atan,
    "sinh": ca.sinh,
    "cosh": ca.cosh,
    "tanh": ca.tanh,
    "asinh": ca.asinh,
    "acosh": ca.acosh,
    "atanh": ca.atanh,
    "exp": ca.exp,
    "log": ca.log,
    "log10": ca.log10,
    "sqrt": ca.sqrt,
    "abs": ca.fabs,
    "sign": ca.sign,
    "atan2": ca.atan2,
    "hypot": lambda a, b: ca.sqrt(a * a + b * b),
    "min": lambda *arguments: functools.reduce(ca.fmin, arguments),
    "max": lambda *arguments: functools.reduce(ca.fmax, arguments),
}
"""Every operator and function of the language (``schemas.expressions.tree``)."""


def evaluate(tree: Tree, scope: Mapping[str, SX]) -> SX:
    """The tree as a scalar CasADi expression over the symbols of ``scope``."""

    def lookup(name: Name) -> SX:
        return scope[name.name]

    return SX(fold(tree, FUNCTIONS, lookup))
