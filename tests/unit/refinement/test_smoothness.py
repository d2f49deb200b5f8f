"""What published curves tell of smoothness."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas.results import CurveGroup, PhaseResult
from solver.refinement.curves import bends, decay, seams
from solver.refinement.hp import SMOOTH
from solver.refinement.merge import SEAM

Array = NDArray[np.float64]
KNOTS = np.linspace(0.0, 2.0, 5)


def result(
    state: Callable[[Array], Array], control: Callable[[Array], Array], points: int
) -> PhaseResult:
    """A phase of four segments, both curves through ``points`` inner places of each."""
    nodes = np.polynomial.chebyshev.chebpts1(points)
    times = KNOTS[:-1, None] + np.diff(KNOTS)[:, None] * (nodes + 1) / 2
    groups = {}
    for group, name, function in (("states", "x", state), ("controls", "u", control)):
        curves = Curves.through([name], KNOTS, nodes, function(times)[:, :, None])
        groups[group] = CurveGroup.model_validate(curves.to_dict())
    return PhaseResult(name="phase", knots=KNOTS.tolist(), groups={}, curves=groups)


def test_the_decay_of_a_geometric_series() -> None:
    def pole(t: Array) -> Array:
        s = 4 * (t % 0.5) - 1
        return np.asarray(1 / (1.25 - s))  # coefficients fall by 2 with every degree

    rates = decay(result(pole, np.cos, 24), np.full(4, 23))
    np.testing.assert_allclose(rates, np.log(2), rtol=0.02)


def test_a_kink_is_rough_and_the_rest_is_smooth() -> None:
    rates = decay(result(lambda t: np.abs(t - 0.7), np.cos, 7), np.full(4, 6))
    assert rates[1] < SMOOTH
    assert np.all(np.isinf(np.delete(rates, 1))), "a straight line has nothing above degree 1"


def test_a_smooth_state_is_smooth_everywhere() -> None:
    assert np.all(decay(result(np.sin, np.cos, 5), np.full(4, 4)) > SMOOTH)


def test_only_the_segments_own_degree_counts() -> None:
    curves = result(np.exp, np.cos, 9)
    fine = decay(curves, np.full(4, 8))
    np.testing.assert_allclose(decay(curves, np.full(4, 4)), fine, rtol=0.3)


@pytest.mark.parametrize("points", [2, 4])
def test_a_jump_of_the_control_is_a_seam(points: int) -> None:
    def jump(t: Array) -> Array:
        return np.where(t < 1.0, -1.0, 1.0)

    apart = seams(result(np.sin, jump, points))
    np.testing.assert_allclose(apart, [0, 1, 0], atol=1e-12)


def test_smooth_controls_have_small_seams() -> None:
    assert np.all(seams(result(np.sin, lambda t: 3 + 2 * t, 3)) < 1e-12)
    assert np.all(seams(result(np.sin, np.cos, 6)) < 1e-3)
    np.testing.assert_array_equal(seams(result(np.sin, np.ones_like, 3)), 0)


def test_a_kink_bends_a_control_by_its_slope_times_the_shorter_segment() -> None:
    def kink(t: Array) -> Array:
        return np.maximum(t - 1.0, 0.0)

    apart = result(np.sin, kink, 3)
    np.testing.assert_allclose(bends(apart), [0, 0.5, 0], atol=1e-12)
    np.testing.assert_allclose(bends(apart), seams(apart), atol=1e-12)


def test_what_the_solver_leaves_of_a_rest_does_not_bend() -> None:
    """Pieces of degree 8 that are off by half a ten-thousandth, before a jump of one."""
    rng = np.random.default_rng(0)

    def rest(t: Array) -> Array:
        return np.where(t < 1.5, 5e-5 * rng.choice([-1.0, 1.0], t.shape), 1.0)

    noisy = result(np.sin, rest, 9)
    assert np.all(seams(noisy)[:2] > 1), "continued, they are apart"
    apart = bends(noisy)
    assert np.all(apart[:2] < SEAM)
    assert apart[2] > 1


@pytest.mark.parametrize("points", [2, 3, 5, 9])
def test_a_bend_counts_the_same_at_every_degree(points: int) -> None:
    """A kink by its slope times the shorter piece; a curvature that jumps by a half, or more."""
    kink = bends(result(np.sin, lambda t: np.maximum(t - 1.0, 0.0), points))
    np.testing.assert_allclose(kink[1], 0.5, rtol=1e-6)
    if points > 2:
        curved = bends(result(np.sin, lambda t: np.maximum(t - 1.0, 0.0) ** 2, points))
        assert 0.1 <= curved[1] <= 0.26, "continued by half a second it is 0.25"


@pytest.mark.parametrize("group", ["controls", "rates"])
def test_only_the_shorter_side_counts_for_a_bend(group: str) -> None:
    """u = t to the knot at 0.1 and 0.1 after it, over [0, 1.1]: a range of 0.1."""
    knots = np.array([0.0, 0.1, 1.1])
    nodes = np.polynomial.chebyshev.chebpts1(2)
    times = knots[:-1, None] + np.diff(knots)[:, None] * (nodes + 1) / 2
    curves = Curves.through(["u"], knots, nodes, np.minimum(times, 0.1)[:, :, None])
    groups = {group: CurveGroup.model_validate(curves.to_dict())}
    phase = PhaseResult(name="phase", knots=knots.tolist(), groups={}, curves=groups)
    np.testing.assert_allclose(bends(phase), [1.0])
    np.testing.assert_allclose(seams(phase), [10.0])
