"""One language, three evaluators: numpy judges, casadi solves, floats resolve constants."""

import itertools
import math
from collections.abc import Callable, Sequence

import casadi as ca
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from schemas.expressions import Call, ExpressionError, Name, Number, Tree
from schemas.expressions.constant import FLOATS, constant
from schemas.expressions.tree import FUNCTIONS, OPERATORS, walk
from solver.expressions import FUNCTIONS as SYMBOLIC
from solver.expressions import SX
from solver.expressions import evaluate as symbolic
from solver.numeric import evaluate
from solver.numeric.functions import FUNCTIONS as NUMERIC

LANGUAGE = {**OPERATORS, **FUNCTIONS}
JUMPING = {"sign", "atan2"}
"""Rounding, or the sign of a zero, decides where these jump; they are compared on their own."""
POINTS = (-2.5, -1.0, -0.3, 0.0, 0.3, 0.5, 1.0, 1.7, 3.0)


def by_casadi(tree: Tree, names: Sequence[str]) -> Callable[..., float]:
    """Over symbols, as the engine does it: casadi's folding of constants has its own rules."""
    symbols = {name: SX.sym(name) for name in names}
    function = ca.Function("tree", list(symbols.values()), [symbolic(tree, symbols)])
    return lambda *values: float(function(*values))


@pytest.mark.parametrize("table", [FLOATS, SYMBOLIC, NUMERIC])
def test_each_speaks_the_whole_language(table: dict) -> None:
    assert set(table) == set(LANGUAGE)


@pytest.mark.parametrize("function", LANGUAGE)
def test_they_agree_on_every_function(function: str) -> None:
    least, most = LANGUAGE[function]
    count = 3 if most is None else least
    names = ["a", "b", "c"][:count]
    tree = Call(function, tuple(Name(name) for name in names))
    engine = by_casadi(tree, names)
    for point in itertools.product(POINTS, repeat=count):
        values = dict(zip(names, point, strict=True))
        expected = evaluate(tree, values)
        assert engine(*point) == pytest.approx(expected, rel=1e-13, abs=1e-15, nan_ok=True)
        if math.isfinite(expected):
            assert constant(tree, values) == pytest.approx(expected, rel=1e-13, abs=1e-15)
        else:
            with pytest.raises(ExpressionError):
                constant(tree, values)


def calls(children: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    def of(function: str) -> st.SearchStrategy[Tree]:
        least, most = LANGUAGE[function]
        arguments = st.lists(children, min_size=least, max_size=4 if most is None else most)
        return arguments.map(lambda trees: Call(function, tuple(trees)))

    return st.sampled_from(sorted(set(LANGUAGE) - JUMPING)).flatmap(of)


VALUES = st.floats(-3, 3).map(lambda value: round(value, 2))
LEAVES = st.one_of(VALUES.map(Number), st.sampled_from(["a", "b"]).map(Name))
TREES = st.recursive(LEAVES, calls, max_leaves=12)


@given(TREES, VALUES, VALUES)
def test_they_agree_on_random_trees(tree: Tree, a: float, b: float) -> None:
    """Away from where rounding decides: every value on the way is finite and of middling size."""
    values = {"a": a, "b": b}
    on_the_way = [abs(evaluate(node, values)) for node in walk(tree)]
    assume(all(size == 0 or 1e-3 < size < 1e3 for size in on_the_way))
    expected = evaluate(tree, values)
    assert by_casadi(tree, ["a", "b"])(a, b) == pytest.approx(expected, rel=1e-8, abs=1e-8)
    assert constant(tree, values) == pytest.approx(expected, rel=1e-8, abs=1e-8)
