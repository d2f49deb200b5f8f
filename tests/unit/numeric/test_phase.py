"""A form's curves are found by name, and everything over its names can be evaluated."""

import numpy as np
import pytest

from schemas.expressions import parse
from schemas.results import PhaseResult
from solver.numeric import (
    MalformedCurves,
    PhaseCurves,
    along,
    departure,
    dynamics,
    flow,
    named,
)
from tests.support.exact import curves, result
from tests.support.forms import form

CHAIN = form({"x": "u", "u": "d(u)", "d(u)": "dd(u)"}, ["dd(u)"])
"""A control whose second derivative is used."""


def published() -> PhaseResult:
    """x = t^4 over 2 s, its control and that control's rates, each on breaks of its own."""
    whole = result({"x": lambda t: t**4}, {"u": lambda t: 4 * t**3}, np.array([0.0, 1.0, 2.0]), 4)
    rates = {"d(u)": lambda t: 12 * t**2, "dd(u)": lambda t: 24 * t}
    finer = curves(rates, np.array([0.0, 0.5, 1.0, 2.0]), 2)
    return whole.model_copy(update={"curves": {**whole.curves, "rates": finer}})


def test_a_control_may_be_a_state_of_the_form() -> None:
    read = PhaseCurves.read(CHAIN, published())
    assert read.breaks.tolist() == [0, 0.5, 1, 2]
    at = read.grid(np.linspace(-1, 1, 7))
    assert at.x == pytest.approx(np.stack([at.t**4, 4 * at.t**3, 12 * at.t**2]), abs=1e-12)
    assert at.u == pytest.approx(24 * at.t[None], abs=1e-12)
    assert dynamics(CHAIN)(at.t, at.x, at.u) == pytest.approx(np.stack([*at.x[1:], *at.u]))


def test_what_is_missing_is_named() -> None:
    deeper = form({"x": "u", "y": "u"}, ["u", "dd(w)"])
    with pytest.raises(MalformedCurves, match=r"no curve of y, dd\(w\)"):
        PhaseCurves.read(deeper, published())


def test_spans_that_differ_cannot_be_read() -> None:
    whole = published()
    rates = whole.curves["rates"].model_copy(update={"breaks": [0.0, 0.5, 1.0, 2.1]})
    with pytest.raises(MalformedCurves, match="same span"):
        PhaseCurves.read(
            CHAIN, whole.model_copy(update={"curves": {**whole.curves, "rates": rates}})
        )


def test_names_stand_for_states_controls_definitions_statics_and_constants() -> None:
    system = form({"x": "v"}, ["u"], definitions={"y": "x + c", "z": "y*s"}, constants={"c": 5.0})
    t, x, u = np.arange(3.0), np.array([[1.0, 2.0, 3.0]]), np.array([[7.0, 8.0, 9.0]])
    assert named(system, ["z", "u", "t"], {"s": 2.0})(t, x, u).tolist() == [
        [12, 14, 16],
        [7, 8, 9],
        [0, 1, 2],
    ]
    assert along(system, [parse("z - s*c")], {"s": 2.0})(1.0, x[:, 0], u[:, 0]).tolist() == [2.0]


def test_a_closed_form_departs_from_its_own_curves() -> None:
    shot = form(
        {},
        definitions={"since": "t - initial.t"},
        flow={"x": "initial.x + initial.v*since + push*since^2", "v": "initial.v"},
    )
    motion = {"x": lambda t: 2 + 3 * (t - 1), "v": lambda t: 3 + 0 * t}
    read = PhaseCurves.read(shot, result(motion, {}, np.array([1.0, 2.0]), 1))
    start = departure(shot, read)
    assert start == pytest.approx({"initial.t": 1, "initial.x": 2, "initial.v": 3})
    at = read.grid(np.linspace(-1, 1, 5))
    formula = flow(shot, read, {"push": 0.5})(at.t, at.x, at.u)
    assert formula == pytest.approx(at.x + np.stack([(at.t - 1) ** 2 / 2, 0 * at.t]))
    assert named(shot, ["since"], start)(at.t, at.x, at.u) == pytest.approx(at.t[None] - 1)


def test_only_closed_forms_have_a_departure() -> None:
    assert departure(CHAIN, PhaseCurves.read(CHAIN, published())) == {}
