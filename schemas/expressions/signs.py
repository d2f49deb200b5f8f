"""Which sign the value of an expression has for certain, from the signs of its names."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from schemas.expressions.tree import Name, Number, Tree

Sign = int | None
"""1: never negative, -1: never positive, 0: zero, None: unknown."""

_POSITIVE = frozenset({"abs", "sqrt", "hypot", "exp", "cosh", "acos", "acosh"})
_ODD = frozenset({"sign", "sinh", "tanh", "asinh", "atanh", "asin", "atan"})


def sign_of(tree: Tree, sign: Callable[[str], Sign]) -> Sign:
    """The sign of ``tree``, with ``sign`` for that of each name."""
    if isinstance(tree, Number):
        return sign_of_number(tree.value)
    if isinstance(tree, Name):
        return sign(tree.name)
    if tree.function in _POSITIVE:
        return 1
    if tree.function == "^" and _even(tree.arguments[1]):
        return 1
    rule = _RULES.get(tree.function)
    return rule([sign_of(one, sign) for one in tree.arguments]) if rule else None


def sign_of_number(value: float) -> Sign:
    """The sign of a number."""
    return (value > 0) - (value < 0)


def sign_of_interval(lower: float, upper: float) -> Sign:
    """The sign of everything between two limits."""
    if lower >= 0:
        return 1
    return -1 if upper <= 0 else None


def product(signs: Sequence[Sign]) -> Sign:
    """The sign of a product."""
    known = [sign for sign in signs if sign is not None]
    if 0 in known:
        return 0
    return math.prod(known) if len(known) == len(signs) else None


def _sum(signs: Sequence[Sign]) -> Sign:
    kinds = {sign for sign in signs if sign != 0}
    if not kinds:
        return 0
    return kinds.pop() if len(kinds) == 1 else None


def _opposite(sign: Sign) -> Sign:
    return None if sign is None else -sign


def _greatest(signs: Sequence[Sign]) -> Sign:
    if 1 in signs:
        return 1
    return None if None in signs else max(one for one in signs if one is not None)


def _even(exponent: Tree) -> bool:
    return isinstance(exponent, Number) and exponent.value % 2 == 0


_RULES: Mapping[str, Callable[[Sequence[Sign]], Sign]] = MappingProxyType(
    {
        **dict.fromkeys(_ODD, lambda signs: signs[0]),
        "+": _sum,
        "-": lambda signs: _sum([signs[0], _opposite(signs[1])]),
        "neg": lambda signs: _opposite(signs[0]),
        "*": product,
        "/": product,
        "^": lambda signs: 1 if signs[0] == 1 else None,
        "max": _greatest,
        "min": lambda signs: _opposite(_greatest([_opposite(sign) for sign in signs])),
    }
)
"""Function -> the sign of its value from those of its arguments; others have none for certain."""
