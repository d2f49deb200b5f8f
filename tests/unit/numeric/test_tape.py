"""Expressions in numpy: the whole language, each step once, no noise about NaN."""

import numpy as np
import pytest

from schemas.expressions import parse
from schemas.expressions.tree import FUNCTIONS as LANGUAGE
from schemas.expressions.tree import OPERATORS
from solver.numeric import evaluate
from solver.numeric.functions import FUNCTIONS
from solver.numeric.tape import Scope, record


def test_it_speaks_the_whole_language() -> None:
    assert set(FUNCTIONS) == set(LANGUAGE) | set(OPERATORS)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a + b + 3 - 1", 4.5),
        ("a*b*4", 2 * 0.5 * 4),
        ("-a^3", -8.0),
        ("(-a)^3 + (-a)^-2", -8 + 0.25),
        ("(-a)^2", 4.0),
        ("sign(a - 2) + sign(-b) + sign(a)", 0.0),
        ("min(a, b, -1) + max(a, b, 7, 3)", 6.0),
        ("atan2(b, -a) + hypot(3*b, a)", np.arctan2(0.5, -2) + 2.5),
        ("log10(50*a) + abs(-b)", 2.5),
    ],
)
def test_values(text: str, value: float) -> None:
    assert evaluate(parse(text), {"a": 2.0, "b": 0.5}) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["sqrt(-a)", "log(a - a) - log(b - b)", "(-a)^b", "asin(a)"])
def test_what_has_no_value_is_nan_without_a_warning(text: str) -> None:
    assert np.isnan(evaluate(parse(text), {"a": 2.0, "b": 0.5}))
    over_points = record([parse(text)], Scope(["a", "b"]))
    assert np.isnan(over_points([np.full(3, 2.0), np.full(3, 0.5)], (3,))).all()


def test_equal_subexpressions_are_computed_once() -> None:
    texts = ["sin(x)^2 + cos(x)", "cos(x) + sin(x)^2 * 3", "sin(x)"]
    tape = record([parse(text) for text in texts], Scope(["x"]))
    assert len(tape.steps) == 6  # sin, square, cos, +, * 3, +


def test_intermediates_are_shared_and_those_not_used_leave_no_steps() -> None:
    definitions = {
        "unused": parse("exp(x)"),
        "s": parse("sin(x)"),
        "den": parse("1 + s*s"),
    }
    tape = record([parse("den/s"), parse("den")], Scope(["x"], {}, definitions))
    assert len(tape.steps) == 4  # sin, *, 1 +, /
    x = np.linspace(0.1, 2, 5)
    den = 1 + np.sin(x) ** 2
    assert tape([x], (5,)) == pytest.approx(np.stack([den / np.sin(x), den]))


def test_a_chain_of_intermediates_may_be_longer_than_pythons_stack() -> None:
    definitions = {"n0": parse("x")}
    definitions |= {f"n{k}": parse(f"n{k - 1} + 1") for k in range(1, 3000)}
    tape = record([parse("n2999")], Scope(["x"], {}, definitions))
    assert tape([np.zeros(2)], (2,)).tolist() == [[2999.0, 2999.0]]


def test_what_is_constant_is_folded_and_fills_its_row() -> None:
    tape = record([parse("g*m/2"), parse("x*(g*m/2)")], Scope(["x"], {"g": 10.0, "m": 3.0}))
    assert len(tape.steps) == 1
    assert tape([np.array([1.0, 2.0])], (2,)).tolist() == [[15.0, 15.0], [15.0, 30.0]]


def test_no_expressions_give_no_rows() -> None:
    assert record([], Scope(["x"]))([np.zeros(4)], (4,)).shape == (0, 4)
