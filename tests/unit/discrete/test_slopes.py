"""Slope arithmetic: exact changes, derivatives at steps of no length, and no holes in between."""

import casadi as ca
import numpy as np
import pytest

from schemas.expressions import FUNCTIONS, OPERATORS, Name, Number, parse
from schemas.expressions.tree import Call, Tree
from solver.discrete.rules import RULES
from solver.discrete.slopes import Slopes
from solver.expressions import SX, evaluate

TREES = {
    "+": "x + y + 2 + x",
    "-": "x - y",
    "neg": "-x",
    "*": "3*x*y*(x + y)",
    "/": "x/(2 + y^2)",
    "^": "x^2 + y^5 - (2 + x^2)^(-3) + (1 + y^2)^1.5 + (1 + x^2)^0.3 + (2 + x^2)^(y/3)",
    "sin": "sin(2*x - y)",
    "cos": "cos(x)*cos(x + y)",
    "tan": "tan(0.3*sin(x))",
    "asin": "asin(0.8*sin(x))",
    "acos": "acos(y/(1 + y^2))",
    "atan": "atan(2*x)",
    "sinh": "sinh(x)",
    "cosh": "cosh(x - y)",
    "tanh": "tanh(3*x)",
    "asinh": "asinh(x)",
    "acosh": "acosh(1.5 + x^2)",
    "atanh": "atanh(0.7*cos(x))",
    "exp": "exp(-x^2)",
    "log": "log(0.3 + x^2)",
    "log10": "log10(1.3 + y^2)",
    "sqrt": "sqrt(0.1 + x^2*y^2)",
    "abs": "abs(x) + abs(y - 1)",
    "sign": "sign(x - 0.2)",
    "atan2": "atan2(1 + x^2, y)",
    "hypot": "hypot(x - 1, y)",
    "min": "min(x, y, 0.3)",
    "max": "max(x, y, -0.3)*x",
}
SMOOTH = [name for name in TREES if name not in ("abs", "sign", "min", "max")]


def slopes_of(text: str) -> tuple[ca.Function, SX, SX, SX]:
    """The row of an expression over x and y, with symbols for both ends."""
    before, after = SX.sym("before", 2), SX.sym("after", 2)
    leaves = {name: (before[i], after[i], SX(0)) for i, name in enumerate("xy")}
    tree = parse(text)
    row = Slopes(leaves, {}, {}).row(tree)
    ends = [
        evaluate(tree, {name: side[i] for i, name in enumerate("xy")}) for side in (before, after)
    ]
    function = ca.Function("row", [before, after], [row, ends[1] - ends[0]])
    return function, before, after, row


def test_every_function_has_a_rule_and_a_tree() -> None:
    assert set(RULES) == set(TREES) == {*FUNCTIONS, *OPERATORS}


@pytest.mark.parametrize("name", TREES)
def test_rows_times_steps_are_changes(name: str) -> None:
    """Of steps from a billionth to several units."""
    function, *_ = slopes_of(TREES[name])
    rng = np.random.default_rng(0)
    for size in (1e-9, 1e-6, 1e-4, 1e-3, 0.03, 0.1, 0.5, 2.0, 4.0):
        before = rng.normal(size=2)
        step = size * rng.normal(size=2)
        row, change = (np.array(one).ravel() for one in function(before, before + step))
        scale = 1 + float(np.abs(row) @ np.abs(step))
        np.testing.assert_allclose(row @ step, change[0], atol=5e-13 * scale)


@pytest.mark.parametrize("name", SMOOTH)
def test_steps_of_no_length_have_derivatives(name: str) -> None:
    """And first and second derivatives of the row there, and just beside."""
    function, before, after, row = slopes_of(TREES[name])
    both = ca.vertcat(before, after)
    first = ca.jacobian(row, both)
    second = ca.Function("second", [before, after], [first, ca.jacobian(ca.vec(first), both)])
    place = SX.sym("place", 2)
    value = evaluate(parse(TREES[name]), {one: place[i] for i, one in enumerate("xy")})
    gradient = ca.Function("gradient", [place], [ca.gradient(value, place)])
    hessian = ca.Function("hessian", [place], [ca.hessian(value, place)[0]])
    at = np.array([0.4, -0.7])
    start = np.array(function(at, at)[0]).ravel()
    np.testing.assert_allclose(start, np.array(gradient(at)).ravel(), atol=1e-9)
    for step in (0.0, 1e-9, 1e-6, 3e-4, 1e-3):
        found = [np.array(one) for one in second(at, at + step)]
        assert all(np.isfinite(one).all() for one in found)
        # half of what the value's second derivative is, for each end
        np.testing.assert_allclose(
            found[0][:, :2] + found[0][:, 2:], np.array(hessian(at + step / 2)), atol=2e-5
        )


@pytest.mark.parametrize("name", ["sin", "cos", "tanh", "exp", "log", "atan2"])
def test_rows_are_smooth_where_series_take_over(name: str) -> None:
    """A finite difference of the row across every size of step is its derivative."""
    function, before, after, row = slopes_of(TREES[name])
    slope = ca.Function("slope", [before, after], [ca.jacobian(row, after)])
    at, along = np.array([0.4, 0.9]), np.array([1.0, -0.6])
    for size in np.geomspace(1e-5, 0.5, 60):
        tiny = 1e-3 * size
        low, high = (np.array(function(at, at + s * along)[0]) for s in (size - tiny, size + tiny))
        expected = np.array(slope(at, at + size * along)) @ along
        np.testing.assert_allclose(
            (high - low).ravel() / (2 * tiny), expected, atol=1e-6 + 1e-14 / tiny
        )


def test_values_and_names_are_shared() -> None:
    """Long chains of names neither grow without bound nor run out of Python's stack."""
    trees: dict[str, Tree] = {"n0": Name("x")}
    for i in range(1, 3000):
        one = Name(f"n{i - 1}")
        trees[f"n{i}"] = Call("+", (one, Call("*", (Number(1e-3), Call("*", (one, one))))))
    x = SX.sym("x", 2)
    slopes = Slopes({"x": (x[0], x[1], SX(1))}, trees, {})
    row = ca.Function("row", [x], [slopes.row(Name("n2999"))], {"cse": True})
    assert row.n_instructions() < 20 * 3000


def test_constants_have_no_place() -> None:
    x = SX.sym("x", 2)
    slopes = Slopes({"x": (x[0], x[1], SX(1))}, {"twice": parse("2*k")}, {"k": SX(3)})
    assert not slopes.of(parse("sin(twice) + k^2/7")).varies
    assert slopes.row(parse("twice*k")).nnz() == 0 or slopes.row(parse("twice*k")).is_zero()
    assert float(slopes.row(parse("twice*x"))) == 6
