"""The mesh error against integrals known by hand, and its quadrature against a finer one."""

from collections.abc import Callable

import numpy as np
import pytest

from schemas.problem import Problem
from solver.lowering import lower
from solver.lowering.form import Form
from solver.numeric import PhaseCurves, Samples, dynamics, integrate
from solver.refinement.error import segment_errors
from tests.support.exact import altered, block_problem, block_result, curves, result
from tests.support.forms import form, unknowns


def block() -> Form:
    return lower(block_problem())[0]


def oscillator(damping: float = 0.0) -> Form:
    system = {
        "kind": "ode",
        "states": ["x", "v"],
        "controls": [],
        "derivatives": {"x": "v", "v": f"-x - {damping}*abs(v)"},
    }
    phase = {"system": system, "time": {"final": 6}}
    return lower(Problem.model_validate({"phases": [phase]}))[0]


def test_an_exact_motion_has_no_error() -> None:
    assert segment_errors(block(), block_result(), {}) == pytest.approx(0, abs=1e-15)


def test_the_error_is_the_integral_of_the_defect_in_its_segment() -> None:
    """u off by 0.3 on a segment of 1/4 s: eta = 0.075 of v, whose largest size is 1.5 m/s."""

    def off(rows: np.ndarray) -> np.ndarray:
        rows[2, 0] -= 0.3
        return rows

    errors = segment_errors(block(), altered(block_result(), "controls", "u", off), {})
    assert errors == pytest.approx([0, 0, 0.3 * 0.25 / 2.5, 0], abs=1e-14)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_it_falls_with_the_segments_at_the_order_of_the_curves(degree: int) -> None:
    """x' of a degree-n interpolant is off by h^n, over a segment's length by h^(n+1)."""
    counts = np.array([8, 16, 32])
    errors = [
        segment_errors(
            oscillator(),
            result({"x": np.sin, "v": np.cos}, {}, np.linspace(0, 6, n + 1), degree),
            {},
        ).max()
        for n in counts
    ]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(degree + 1, abs=0.2)


@pytest.mark.parametrize("degree", [2, 3])
def test_the_stated_quadrature_is_within_two_percent(degree: int) -> None:
    """Of an adaptive one; the integrand has kinks wherever the defect changes its sign."""
    damped = oscillator(damping=0.4)
    published = result({"x": np.sin, "v": np.cos}, {}, np.linspace(0, 6, 14), degree)
    curves, f = PhaseCurves.read(damped, published), dynamics(damped)
    slopes = curves.states.slopes()

    def defect_in(segment: int) -> Callable[[Samples], np.ndarray]:
        def integrand(at: Samples) -> np.ndarray:
            s = 2 * (at.t - curves.breaks[segment]) / curves.lengths[segment] - 1
            here = np.abs(s) <= 1
            rate = slopes.at(np.full(len(s), segment), np.clip(s, -1, 1))
            rate *= 2 / curves.lengths[segment]
            return np.abs(rate - f(at.t, at.x, at.u)) * here

        return integrand

    scale = 1 + np.abs(curves.states.grid(np.linspace(-1, 1, 9))).max(axis=(1, 2))
    adaptive = [
        (integrate(curves, defect_in(k), 1e-9).value / scale).max() for k in range(curves.segments)
    ]
    assert segment_errors(damped, published, {}) == pytest.approx(adaptive, rel=0.02)


def test_dynamics_without_a_value_are_nan_in_their_segments_only() -> None:
    document = block_problem().model_dump(mode="json")
    document["phases"][0]["system"]["derivatives"]["v"] = "u + 0*sqrt(0.5 - x)"
    rooted = lower(Problem.model_validate(document))[0]
    assert np.isnan(segment_errors(rooted, block_result(), {})).tolist() == [
        False,
        False,
        True,
        True,
    ]


def test_an_implicit_system_has_the_error_of_its_accelerations() -> None:
    """However the residual is scaled: it is that of the system written with its accelerations."""
    published = result({"q": np.sin, "d(q)": np.cos}, {}, np.linspace(0, 6, 9), 3)
    plain = form({"q": "d(q)", "d(q)": "-q - 0.1*d(q)"})
    expected = segment_errors(plain, published, {})
    assert expected.min() > 1e-3
    for scale in ("1", "1e4", "exp(3*q)"):
        group = unknowns(["dd(q)"], f"{scale}*(dd(q) + q + 0.1*d(q))")
        implicit = form({"q": "d(q)", "d(q)": "dd(q)"}, unknowns=(group,))
        assert segment_errors(implicit, published, {}) == pytest.approx(expected, rel=1e-9)


def test_statics_are_part_of_the_dynamics() -> None:
    published = result({"x": lambda t: 2 * t}, {}, np.array([0.0, 1.0, 3.0]), 1)
    moving = form({"x": "speed"})
    assert segment_errors(moving, published, {"speed": 2.0}) == pytest.approx(0, abs=1e-14)
    assert segment_errors(moving, published, {"speed": 1.5}) == pytest.approx([0.5 / 7, 1.0 / 7])


def test_a_control_whose_rate_is_used_has_an_error_of_its_own() -> None:
    breaks = np.linspace(0.0, 1.0, 5)
    published = result({"x": lambda t: t**2}, {"u": lambda t: 2 * t}, breaks)
    rates = curves({"d(u)": lambda t: np.where(t < 0.5, 2.0, 2.3)}, breaks, 0)
    published = published.model_copy(update={"curves": {**published.curves, "rates": rates}})
    chain = form({"x": "u", "u": "d(u)"}, ["d(u)"])
    off = 0.3 * 0.25 / 3
    assert segment_errors(chain, published, {}) == pytest.approx([0, 0, off, off], abs=1e-14)


def test_a_closed_form_is_off_by_its_distance_from_the_formula() -> None:
    fall = form({}, flow={"x": "initial.x + rate*(t^2 - initial.t^2)"})
    exact = result({"x": lambda t: 7 + t**2}, {}, np.array([1.0, 2.0, 4.0]), 2)
    assert segment_errors(fall, exact, {"rate": 1.0}) == pytest.approx(0, abs=1e-14)
    steep = segment_errors(fall, exact, {"rate": 1.1})
    assert steep == pytest.approx([0.1 * 3 / 24, 0.1 * 15 / 24])
