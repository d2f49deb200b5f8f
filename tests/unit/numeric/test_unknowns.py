"""Unknowns are found at every point at once, exactly where the equations are affine in them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from schemas.expressions import parse
from solver.lowering.form import Unknowns
from solver.numeric import along, dynamics, named
from solver.numeric.tape import Tape
from tests.support.forms import form, unknowns

X = np.linspace(-2.0, 2.0, 41)


def values(group: Unknowns, *names: str, x: np.ndarray = X, **given: float) -> np.ndarray:
    """The unknowns over x, which is the only state."""
    system = form({"x": "1"}, unknowns=(group,))
    return named(system, names or group.names, given)(0 * x, x[None], np.empty((0, *x.shape)))


def cart_pole() -> tuple[Unknowns, dict[str, float]]:
    """Kelly's thesis, 8.37 and 8.38: a force on the cart, an angle from hanging down."""
    group = unknowns(
        ["dd(x)", "dd(q)"],
        "(m1 + m2)*dd(x) + m2*l*dd(q)*cos(q) - m2*l*w^2*sin(q) - u",
        "l*dd(q) + dd(x)*cos(q) + g*sin(q)",
    )
    return group, {"m1": 2.0, "m2": 0.5, "l": 0.5, "g": 9.81}


def test_accelerations_of_a_mechanism_are_those_of_the_explicit_formula() -> None:
    group, p = cart_pole()
    system = form({"q": "w", "w": "dd(q)", "v": "dd(x)"}, ["u"], unknowns=(group,), constants=p)
    rng = np.random.default_rng(1)
    q, w, v, u = rng.normal(size=(4, 30, 20)) * 3
    rates = dynamics(system)(0 * q, np.stack([q, w, v]), u[None])
    s, c, m, length = np.sin(q), np.cos(q), p["m2"], p["l"]
    den = p["m1"] + m * s**2
    cart = (length * m * s * w**2 + u + m * p["g"] * c * s) / den
    pole = -(length * m * c * s * w**2 + u * c + (p["m1"] + m) * p["g"] * s) / (length * den)
    assert rates == pytest.approx(np.stack([w, pole, cart]), rel=1e-13, abs=1e-13)


def test_affine_equations_cost_one_jacobian(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = []
    original = Tape.__call__

    def counted(tape: Tape, inputs: Sequence[Any], shape: tuple[int, ...]) -> np.ndarray:
        runs.append(shape)
        return original(tape, inputs, shape)

    monkeypatch.setattr(Tape, "__call__", counted)
    a = values(unknowns(["a"], "(1 + x^2)*a - sin(x) + 1e4"))[0]
    assert a == pytest.approx((np.sin(X) - 1e4) / (1 + X**2), rel=1e-14)
    assert runs == [(2, 41), (1, 41), (41,)]  # the columns, the rest, what was asked for


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_units_do_not_matter(size: float) -> None:
    group = unknowns(["a", "b"], "m*a + m*x*b - 3", "m*b - m*x*a - x")
    a, b = values(group, m=size)
    assert size * a + size * X * b == pytest.approx(np.full(X.shape, 3.0), rel=1e-12)
    assert size * b - size * X * a == pytest.approx(X, rel=1e-12, abs=1e-12)


def test_equations_that_are_not_affine_take_more_steps() -> None:
    a, b = values(unknowns(["a", "b"], "a + a^3/5 + b - x", "b + sin(b)/2 - a"))
    assert a + a**3 / 5 + b == pytest.approx(X, abs=1e-12)
    assert b + np.sin(b) / 2 == pytest.approx(a, abs=1e-12)


def test_a_point_without_a_solution_is_nan_and_spoils_no_other() -> None:
    exactly = values(unknowns(["a", "b"], "x*a + b - 1", "x*a + b*(1 + x) - 2"))
    assert np.isnan(exactly).all(axis=0).tolist() == (X == 0).tolist()
    nowhere = values(unknowns(["a"], "a^2 + 1"))
    assert np.isnan(nowhere).all()
    undefined = values(unknowns(["a"], "a - sqrt(x)"))[0]
    assert np.isnan(undefined).tolist() == (X < 0).tolist()


def test_equations_that_depend_on_each_other_but_for_rounding_have_no_solution() -> None:
    dependent = unknowns(["a", "b"], "0.1*a + 0.3*b - x", "(0.1 + 0.2)*a + 0.9*b - 1")
    assert np.isnan(values(dependent)).all()


def test_later_groups_use_earlier_ones_and_definitions() -> None:
    groups = (unknowns(["a"], "2*a - x"), unknowns(["b"], "b + twice + a - 1"))
    system = form({"x": "1"}, definitions={"twice": "2*a", "sum": "a + b"}, unknowns=groups)
    found = along(system, [parse("sum"), parse("b")])(0 * X, X[None], np.empty((0, 41)))
    assert found == pytest.approx(np.stack([1 - X, 1 - 1.5 * X]))


def test_unknowns_that_are_not_asked_for_are_not_solved_for() -> None:
    groups = (unknowns(["a"], "a - x"), unknowns(["b"], "b - a"))
    system = form({"x": "1"}, unknowns=groups)
    assert len(named(system, ["x"]).solves) == 0
    assert len(named(system, ["a"]).solves) == 1
    assert len(named(system, ["b"]).solves) == 2


def test_a_cubic_is_solved_from_anywhere() -> None:
    """Its slope at one is four times that at zero: a chord over so long a way leads astray."""
    wide = np.linspace(-1e3, 1e3, 2001)
    group = unknowns(["a"], "a^3 + a - 5*x + sin(x)")
    system = form({"x": "1"}, unknowns=(group,))
    (a,) = along(system, [parse("a")])(0 * wide, wide[None], np.empty((0, len(wide))))
    assert a**3 + a == pytest.approx(5 * wide - np.sin(wide), rel=1e-9, abs=1e-9)
