"""Turns in space: from a rotation's entries to its angle, and how far one step may turn."""

import casadi as ca
import numpy as np
import pytest

from solver.discrete import turn_rows
from solver.discrete.differences import angle_over_sine
from solver.discrete.turning import LARGEST
from solver.expressions import SX
from solver.mechanics.spatial_principle import spatial_principle
from solver.numeric.tape import Array
from tests.unit.discrete.spatial_systems import SYSTEMS


@pytest.mark.parametrize("angle", [1e-12, 1e-6, 1e-3, 0.05, 0.0707, 0.071, 0.5, 1.5, 2.5])
def test_an_angle_over_its_sine(angle: float) -> None:
    """With its slope by what it is made of, on both sides of where the series ends."""
    x = SX.sym("x")
    size = angle_over_sine(x)
    run = ca.Function("size", [x], [size, ca.jacobian(size, x)])
    value, slope = (float(one) for one in run(2 * np.sin(angle / 2) ** 2))
    assert value == pytest.approx(angle / np.sin(angle), rel=1e-12)
    expected = 1 / 3 if angle < 1e-4 else (1 - angle / np.tan(angle)) / np.sin(angle) ** 2
    assert slope == pytest.approx(expected, rel=1e-6 if angle < 0.1 else 1e-10)


def test_it_stays_finite_at_half_a_turn() -> None:
    x = SX.sym("x")
    size = angle_over_sine(x)
    run = ca.Function("size", [x], [size, ca.jacobian(size, x)])
    assert np.all(np.isfinite([float(one) for one in run(2.0)]))


def limits(name: str, q0: Array, q1: Array) -> dict[str, tuple[float, float, float]]:
    rows = turn_rows(spatial_principle(SYSTEMS[name]), SX(q0), SX(q1))
    return {label: (float(value), lower, upper) for label, value, lower, upper in rows}


def test_hinges_and_quaternions_turn_by_a_radian_at_most() -> None:
    """A follower counts by what it turns itself; sliders are free."""
    names = list(SYSTEMS["tree"].coordinates)
    start, end = np.zeros(len(names)), np.zeros(len(names))
    w, x = names.index("base.qw"), names.index("base.qx")
    start[w], end[w], end[x] = 1.0, np.cos(0.4), np.sin(0.4)
    end[names.index("swing")], end[names.index("slide")] = 0.7, 5.0
    found = limits("tree", start, end)
    assert set(found) == {"turn of swing", "turn of askew", "turn of base"}
    assert found["turn of swing"] == pytest.approx((0.7, -LARGEST, LARGEST))
    value, lower, upper = found["turn of base"]
    assert upper == np.inf
    assert value == pytest.approx(np.cos(0.8 / 2))
    assert lower == pytest.approx(np.cos(LARGEST / 2))
