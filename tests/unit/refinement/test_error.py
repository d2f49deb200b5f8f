"""The mesh error against integrals known by hand, and its quadrature against a finer one."""

from collections.abc import Callable

import numpy as np
import pytest

from schemas.phases import Phase
from schemas.problem import Problem
from solver.numeric import PhaseCurves, Samples, dynamics, integrate
from solver.refinement.error import segment_errors
from tests.support.exact import altered, block_problem, block_result, result


def oscillator(damping: float = 0.0) -> Phase:
    system = {
        "kind": "ode",
        "states": ["x", "v"],
        "controls": [],
        "derivatives": {"x": "v", "v": f"-x - {damping}*abs(v)"},
    }
    return Problem.model_validate({"phases": [{"system": system, "time": {"final": 6}}]}).phases[0]


def test_an_exact_motion_has_no_error() -> None:
    assert segment_errors(block_problem().phases[0], block_result()) == pytest.approx(0, abs=1e-15)


def test_the_error_is_the_integral_of_the_defect_in_its_segment() -> None:
    """u off by 0.3 on a segment of 1/4 s: eta = 0.075 of v, whose largest size is 1.5 m/s."""

    def off(rows: np.ndarray) -> np.ndarray:
        rows[2, 0] -= 0.3
        return rows

    errors = segment_errors(
        block_problem().phases[0], altered(block_result(), "controls", "u", off)
    )
    assert errors == pytest.approx([0, 0, 0.3 * 0.25 / 2.5, 0], abs=1e-14)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_it_falls_with_the_segments_at_the_order_of_the_curves(degree: int) -> None:
    """x' of a degree-n interpolant is off by h^n, over a segment's length by h^(n+1)."""
    counts = np.array([8, 16, 32])
    errors = [
        segment_errors(
            oscillator(), result({"x": np.sin, "v": np.cos}, {}, np.linspace(0, 6, n + 1), degree)
        ).max()
        for n in counts
    ]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(degree + 1, abs=0.2)


@pytest.mark.parametrize("degree", [2, 3])
def test_the_stated_quadrature_is_within_two_percent(degree: int) -> None:
    """Of an adaptive one; the integrand has kinks wherever the defect changes its sign."""
    phase = oscillator(damping=0.4)
    published = result({"x": np.sin, "v": np.cos}, {}, np.linspace(0, 6, 14), degree)
    curves, f = PhaseCurves.read(phase, published), dynamics(phase.system)
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
    assert segment_errors(phase, published) == pytest.approx(adaptive, rel=0.02)


def test_dynamics_without_a_value_are_nan_in_their_segments_only() -> None:
    document = block_problem().model_dump(mode="json")
    document["phases"][0]["system"]["derivatives"]["v"] = "u + 0*sqrt(0.5 - x)"
    phase = Problem.model_validate(document).phases[0]
    assert np.isnan(segment_errors(phase, block_result())).tolist() == [False, False, True, True]
