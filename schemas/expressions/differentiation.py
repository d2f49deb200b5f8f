"""Differentiation of trees with respect to time, by the chain rule; trees stay trees.

Products by zero and one, and constants, are folded on the way, so that repeated differentiation
does not drag along what vanishes.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from types import MappingProxyType

from schemas.expressions.constant import FLOATS
from schemas.expressions.tree import Call, Name, Number, Tree

Rate = Callable[[str], Tree | None]
"""The time derivative of a name; None for a constant."""

ZERO, ONE, TWO = Number(0.0), Number(1.0), Number(2.0)


def total_derivative(tree: Tree, rate: Rate) -> Tree:
    """The time derivative of ``tree``, with ``rate`` for that of each name in it.

    Where a function has no derivative (``abs`` and ``sign`` at 0, ``min`` and ``max`` where their
    arguments are equal) the mean of both sides is taken. Recursion is safe for trees as deep as
    the parser lets pass; the result may be a few times as deep as ``tree``.
    """
    if isinstance(tree, Number) or (isinstance(tree, Call) and tree.function == "sign"):
        return ZERO
    if isinstance(tree, Name):
        return rate(tree.name) or ZERO
    name, arguments, column = tree.function, tree.arguments, tree.column
    rates = [total_derivative(argument, rate) for argument in arguments]
    if all(one == ZERO for one in rates):
        return ZERO
    if name in _OPERATORS:
        return _OPERATORS[name](arguments, rates, column)
    return _times(column, _SLOPES[name](arguments[0], column), rates[0])


def _call(function: str, column: int, *arguments: Tree) -> Tree:
    """A call; of numbers its value, where that is a finite number."""
    values = [argument.value for argument in arguments if isinstance(argument, Number)]
    if len(values) == len(arguments):
        try:
            value = FLOATS[function](*values)
        except (ArithmeticError, ValueError):
            value = math.nan
        if math.isfinite(value):
            return Number(value)
    return Call(function, arguments, column)


def _plus(column: int, *terms: Tree) -> Tree:
    """A sum without zeros; terms that differ by a number only are made one."""
    sizes: dict[frozenset[tuple[Tree, int]], float] = {}
    products: dict[frozenset[tuple[Tree, int]], Sequence[Tree]] = {}
    for size, factors in (part for term in terms for part in _parts(term)):
        key = frozenset(Counter(factors).items())
        sizes[key] = sizes.get(key, 0.0) + size
        products.setdefault(key, factors)
    kept = [_scaled(column, size, products[key]) for key, size in sizes.items() if size]
    if len(kept) < 2:
        return kept[0] if kept else ZERO
    return Call("+", tuple(kept), column)


def _parts(term: Tree) -> Iterator[tuple[float, Sequence[Tree]]]:
    """The terms of a sum, also of one that a number multiplies, as numbers and factors."""
    size, factors = _factored(term)
    only = factors[0] if len(factors) == 1 else None
    if isinstance(only, Call) and only.function == "+":
        for part in only.arguments:
            share, inner = _factored(part)
            yield size * share, inner
    else:
        yield size, factors


def _times(column: int, *factors: Tree) -> Tree:
    """A product without ones, its numbers and signs gathered in front; zero where one is zero."""
    pairs = [_factored(factor) for factor in factors]
    size = math.prod(number for number, _ in pairs)
    return _scaled(column, size, [factor for _, rest in pairs for factor in rest])


def _minus(column: int, tree: Tree) -> Tree:
    return _times(column, Number(-1.0), tree)


def _factored(tree: Tree) -> tuple[float, Sequence[Tree]]:
    """A product as its number and its other factors."""
    if isinstance(tree, Number):
        return tree.value, ()
    if isinstance(tree, Call) and tree.function == "neg":
        size, factors = _factored(tree.arguments[0])
        return -size, factors
    if isinstance(tree, Call) and tree.function == "*":
        pairs = [_factored(argument) for argument in tree.arguments]
        return math.prod(size for size, _ in pairs), [one for _, rest in pairs for one in rest]
    return 1.0, (tree,)


def _scaled(column: int, size: float, factors: Sequence[Tree]) -> Tree:
    if size == 0 or not factors:
        return Number(size)
    if size == -1:
        return Call("neg", (_scaled(column, 1.0, factors),), column)
    kept = factors if size == 1 else [Number(size), *factors]
    return kept[0] if len(kept) == 1 else Call("*", tuple(kept), column)


def _over(column: int, numerator: Tree, denominator: Tree) -> Tree:
    if numerator == ZERO or denominator == ONE:
        return numerator
    return _call("/", column, numerator, denominator)


def _power(column: int, base: Tree, exponent: Tree) -> Tree:
    if exponent == ONE:
        return base
    return ONE if exponent == ZERO else _call("^", column, base, exponent)


def _square(column: int, tree: Tree) -> Tree:
    return _power(column, tree, TWO)


def _sum_rule(_: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    return _plus(column, *rates)


def _difference_rule(_: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    return _plus(column, rates[0], _minus(column, rates[1]))


def _negative_rule(_: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    return _minus(column, rates[0])


def _product_rule(factors: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    return _plus(
        column,
        *(
            _times(column, *factors[:place], one, *factors[place + 1 :])
            for place, one in enumerate(rates)
        ),
    )


def _quotient_rule(arguments: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    (a, b), (da, db) = arguments, rates
    loss = _over(column, _times(column, a, db), _square(column, b))
    return _plus(column, _over(column, da, b), _minus(column, loss))


def _power_rule(arguments: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    """Without a logarithm where the exponent is constant: the base may be 0 or negative."""
    (a, b), (da, db) = arguments, rates
    by_base = _times(column, b, _power(column, a, _lower(b, column)), da)
    if db == ZERO:
        return by_base
    by_exponent = _times(column, _call("log", column, a), _call("^", column, a, b), db)
    return _plus(column, by_base, by_exponent) if da != ZERO else by_exponent


def _lower(exponent: Tree, column: int) -> Tree:
    return _plus(column, exponent, Number(-1.0))


def _atan2_rule(arguments: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    (y, x), (dy, dx) = arguments, rates
    turn = _plus(column, _times(column, x, dy), _minus(column, _times(column, y, dx)))
    return _over(column, turn, _plus(column, _square(column, x), _square(column, y)))


def _hypot_rule(arguments: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    (a, b), (da, db) = arguments, rates
    along = _plus(column, _times(column, a, da), _times(column, b, db))
    return _over(column, along, Call("hypot", (a, b), column))


def _extreme_rule(name: str, arguments: Sequence[Tree], rates: Sequence[Tree], column: int) -> Tree:
    """The rate of whichever half holds the extreme: ((1 + s) a' + (1 - s) b') / 2, s = +-1."""
    if len(arguments) == 1:
        return rates[0]
    middle = len(arguments) // 2
    halves = slice(None, middle), slice(middle, None)
    a, b = (_extreme(name, arguments[half], column) for half in halves)
    da, db = (_extreme_rule(name, arguments[half], rates[half], column) for half in halves)
    ahead = Call("-", (a, b) if name == "max" else (b, a), column)
    side = _call("sign", column, ahead)
    by_a = _times(column, _plus(column, ONE, side), da)
    by_b = _times(column, _plus(column, ONE, _minus(column, side)), db)
    return _times(column, Number(0.5), _plus(column, by_a, by_b))


def _extreme(name: str, arguments: Sequence[Tree], column: int) -> Tree:
    return arguments[0] if len(arguments) == 1 else Call(name, tuple(arguments), column)


_OPERATORS: Mapping[str, Callable[[Sequence[Tree], Sequence[Tree], int], Tree]] = MappingProxyType(
    {
        "+": _sum_rule,
        "-": _difference_rule,
        "neg": _negative_rule,
        "*": _product_rule,
        "/": _quotient_rule,
        "^": _power_rule,
        "atan2": _atan2_rule,
        "hypot": _hypot_rule,
        "min": partial(_extreme_rule, "min"),
        "max": partial(_extreme_rule, "max"),
    }
)
"""Function -> its rule: the arguments, their rates and the column to the rate."""


def _reciprocal(c: int, tree: Tree) -> Tree:
    return _over(c, ONE, tree)


def _root(c: int, tree: Tree) -> Tree:
    return _call("sqrt", c, tree)


def _one_minus(c: int, tree: Tree) -> Tree:
    return _plus(c, ONE, _minus(c, tree))


_SLOPES: Mapping[str, Callable[[Tree, int], Tree]] = MappingProxyType(
    {
        "sin": lambda x, c: Call("cos", (x,), c),
        "cos": lambda x, c: _minus(c, Call("sin", (x,), c)),
        "tan": lambda x, c: _plus(c, ONE, _square(c, Call("tan", (x,), c))),
        "asin": lambda x, c: _reciprocal(c, _root(c, _one_minus(c, _square(c, x)))),
        "acos": lambda x, c: _minus(c, _reciprocal(c, _root(c, _one_minus(c, _square(c, x))))),
        "atan": lambda x, c: _reciprocal(c, _plus(c, ONE, _square(c, x))),
        "sinh": lambda x, c: Call("cosh", (x,), c),
        "cosh": lambda x, c: Call("sinh", (x,), c),
        "tanh": lambda x, c: _one_minus(c, _square(c, Call("tanh", (x,), c))),
        "asinh": lambda x, c: _reciprocal(c, _root(c, _plus(c, ONE, _square(c, x)))),
        "acosh": lambda x, c: _reciprocal(c, _root(c, _plus(c, Number(-1.0), _square(c, x)))),
        "atanh": lambda x, c: _reciprocal(c, _one_minus(c, _square(c, x))),
        "exp": lambda x, c: Call("exp", (x,), c),
        "log": lambda x, c: _reciprocal(c, x),
        "log10": lambda x, c: _reciprocal(c, _times(c, Number(math.log(10)), x)),
        "sqrt": lambda x, c: _reciprocal(c, _times(c, TWO, Call("sqrt", (x,), c))),
        "abs": lambda x, c: Call("sign", (x,), c),
    }
)
"""Function of one argument -> its slope at an argument."""
