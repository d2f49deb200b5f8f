"""Derivatives of trees, against differentiated curves."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from schemas.expressions import (
    FUNCTIONS,
    OPERATORS,
    Call,
    Name,
    Number,
    Tree,
    derivative,
    parse,
    split,
    walk,
)
from schemas.expressions.differentiation import total_derivative
from solver.numeric.tape import Scope, record
from tests.unit.lowering.curves import HALF, rate, times

CASES = {
    "+": "x + y + 3 + t",
    "-": "x - y",
    "*": "2*x*y*x",
    "/": "sin(x)/(y + k)",
    "^": "x^3 + y^-2 + x^k + 2^y + x^y + (-x)^2",
    "neg": "-(x*y)",
    **{name: f"{name}(x)" for name in FUNCTIONS},
    **{name: f"{name}(x/2)" for name in ("asin", "acos", "atanh")},
    "acosh": "acosh(1 + x)",
    "abs": "abs(x - 2)*abs(y)",
    "sign": "x*sign(y - 2)",
    "atan2": "atan2(y, -x)",
    "hypot": "hypot(x, 2*y)",
    "min": "min(x^2, y, 9, -x*y)",
    "max": "max(x^2*y, y, k*x, -x*y)",
}
"""Function -> an expression over x in [0.8, 1.2] and y in [0.5, 0.9], away from its kinks."""
NAMES = ("t", "x", "y", "k")


def names(t: np.ndarray, order: int) -> dict[str, np.ndarray]:
    """Derivatives of the curves x = 1 + sin(1.3 t)/5 and y = 0.7 + cos(t)/5, and a constant k."""
    turn = order * np.pi / 2
    x = 1.3**order * np.sin(1.3 * t + turn) / 5 + (order == 0)
    y = np.cos(t + turn) / 5 + 0.7 * (order == 0)
    return {derivative("x", order): x, derivative("y", order): y}


def of_time(name: str) -> Tree | None:
    if name == "t":
        return Number(1.0)
    return None if name == "k" else Name(derivative(name))


def values(tree: Tree, t: np.ndarray) -> np.ndarray:
    known = {"t": t, "k": np.full_like(t, 1.7)}
    for order in range(6):
        known |= names(t, order)
    return record([tree], Scope(list(known)))(list(known.values()), t.shape)[0]


def test_every_function_has_a_case() -> None:
    assert set(CASES) == {*FUNCTIONS, *OPERATORS}
    for name, text in CASES.items():
        assert any(isinstance(node, Call) and node.function == name for node in walk(parse(text)))


@pytest.mark.parametrize("function", CASES)
def test_a_derivative_is_that_of_the_curve_to_the_fourth_order(function: str) -> None:
    tree, t = parse(CASES[function]), times(0.4)
    for _ in range(4):
        differentiated = total_derivative(tree, of_time)
        exact = rate(values(tree, t))
        size = 1 + np.abs(exact).max()
        assert values(differentiated, t) == pytest.approx(exact, abs=2e-9 * size)
        tree = differentiated


LEAVES = st.sampled_from(["x", "y", "t", "k"]).map(Name) | st.floats(-2, 2).map(Number)
SMOOTH = ("sin", "cos", "tanh", "atan", "asinh", "neg")


def _grown(inner: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    one = st.builds(lambda f, a: Call(f, (a,)), st.sampled_from(SMOOTH), inner)
    many = st.builds(
        lambda f, a: Call(f, tuple(a)),
        st.sampled_from("+*"),
        st.lists(inner, min_size=2, max_size=3),
    )
    less = st.builds(lambda a, b: Call("-", (a, b)), inner, inner)
    square = st.builds(lambda a: Call("^", (a, Number(2.0))), inner)
    ratio = st.builds(
        lambda a, b: Call("/", (a, Call("+", (Number(3.0), Call("sin", (b,)))))), inner, inner
    )
    return one | many | less | square | ratio


@given(st.recursive(LEAVES, _grown, max_leaves=12))
def test_derivatives_of_random_expressions(tree: Tree) -> None:
    t = times(0.4)
    here = values(tree, t)
    fit = np.polynomial.chebyshev.chebfit((t - 0.4) / HALF, here, 20)
    assume(np.abs(fit[-4:]).max() < 1e-14 * np.abs(here).max())  # resolved by the points
    exact = rate(here)
    size = 1 + np.abs(here).max() + np.abs(exact).max()
    assert values(total_derivative(tree, of_time), t) == pytest.approx(exact, abs=1e-9 * size)


def test_a_constant_power_needs_no_logarithm() -> None:
    factors = (Number(2.0), Name("x", 1), Name("d(x)"))
    assert total_derivative(parse("x^2"), of_time) == Call("*", factors, 2)
    at_zero = total_derivative(total_derivative(parse("x^2"), of_time), of_time)
    known = {"x": 0.0, "d(x)": 3.0, "dd(x)": 5.0}
    assert record([at_zero], Scope(list(known)))(list(known.values()), ())[0] == 18


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("k^2*sin(k) + 4", Number(0.0)),
        ("3 + x", Name("d(x)")),
        ("x - x", Number(0.0)),
        ("2*t", Number(2.0)),
        ("sign(x*y)", Number(0.0)),
        ("-(-x)", Name("d(x)")),
    ],
)
def test_what_vanishes_is_folded(text: str, shown: Tree) -> None:
    assert total_derivative(parse(text), of_time) == shown


def test_like_terms_are_one() -> None:
    third = parse("x*y")
    for _ in range(3):
        third = total_derivative(third, of_time)
    assert isinstance(third, Call)
    assert third.function == "+"
    assert len(third.arguments) == 4  # as Leibniz has it: 1, 3, 3, 1
    assert {split(node.name).order for node in walk(third) if isinstance(node, Name)} == {
        0,
        1,
        2,
        3,
    }


def test_an_extreme_of_many_stays_small() -> None:
    text = "max(" + ", ".join(f"x^2 - {index}*y" for index in range(60)) + ")"
    given, derived = parse(text), total_derivative(parse(text), of_time)
    assert sum(1 for _ in walk(derived)) < 20 * sum(1 for _ in walk(given))
