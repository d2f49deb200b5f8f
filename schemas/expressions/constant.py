"""Constants: floats, by Python's own ``math``, with the place of what goes wrong."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from schemas.expressions.errors import ExpressionError, quoted
from schemas.expressions.tokens import MAX_CONSTANT
from schemas.expressions.tree import Name, Number, Tree
from schemas.suggest import did_you_mean

_OPEN = frozenset({"free", "open", "none", "inf", "infinity", "nan"})


def _sum(*terms: float) -> float:
    total = terms[0]
    for term in terms[1:]:
        total += term
    return total


FLOATS: Mapping[str, Callable[..., float]] = MappingProxyType(
    {
        "+": _sum,
        "-": lambda a, b: a - b,
        "*": lambda *factors: math.prod(factors),
        "/": lambda a, b: a / b,
        "^": math.pow,
        "neg": lambda a: -a,
        "abs": abs,
        "sign": lambda a: float((a > 0) - (a < 0)),
        "min": min,
        "max": max,
        **{
            name: getattr(math, name)
            for name in (
                *("sin", "cos", "tan", "asin", "acos", "atan"),
                *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
                *("exp", "log", "log10", "sqrt", "atan2", "hypot"),
            )
        },
    }
)
"""Every operator and function over floats."""


def apply(function: str, values: Sequence[float], column: int) -> float:
    """One operator or function applied to constants.

    Raises
    ------
    ExpressionError
        When the value does not exist, is not finite, or is over the limit in size.
    """
    try:
        value = FLOATS[function](*values)
    except ZeroDivisionError:
        raise ExpressionError("division by zero", column) from None
    except OverflowError:
        value = math.inf
    except ValueError:
        shown = ", ".join(f"{value:g}" for value in values)
        call = f"({values[0]:g})^({values[1]:g})" if function == "^" else f"{function}({shown})"
        raise ExpressionError(f"{call} is not a real number", column) from None
    if not abs(value) <= MAX_CONSTANT:
        raise ExpressionError(f"a constant over {MAX_CONSTANT:g} in size", column)
    return value


def constant(tree: Tree, names: Mapping[str, float]) -> float:
    """The value of ``tree``, with every name in it taken from ``names``.

    Raises
    ------
    ExpressionError
        For unknown names, division by zero, overflow, and arguments outside of a domain.
    """
    if isinstance(tree, Number):
        return tree.value
    if isinstance(tree, Name):
        if tree.name not in names:
            raise ExpressionError(
                f"{quoted(tree.name)} is not a constant that is known here",
                tree.column,
                _constant_hint(tree.name, names),
            )
        return names[tree.name]
    values = [constant(argument, names) for argument in tree.arguments]
    return apply(tree.function, values, tree.column)


def _constant_hint(name: str, names: Mapping[str, float]) -> str:
    if name.lower() in _OPEN:
        return "null is open: write a pair such as [0, null]"
    near = did_you_mean(name, names)
    some = ": " + ", ".join(list(names)[:12]) if names else ", of which there are none here"
    return near or f"a constant may use pi and the parameters before it{some}"
