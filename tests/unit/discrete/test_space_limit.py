"""In steps of vanishing length the balance in space is the equations of motion."""

import numpy as np
import pytest

from solver.numeric.tape import Array
from tests.support.spatial_steps import Instance, SpatialRows
from tests.unit.discrete.spatial_systems import SYSTEMS


@pytest.mark.parametrize("name", SYSTEMS)
def test_small_steps_agree_with_the_simulator_to_first_order(name: str) -> None:
    steps = SpatialRows(SYSTEMS[name])
    errors = [np.abs(_error(steps, h)).max() for h in (1e-3, 1e-4)]
    assert errors[0] < 1.0
    assert errors[1] < 0.12 * errors[0]


def _error(steps: SpatialRows, h: float) -> Array:
    """Of the balance over h, against mass, forces and bias of the simulator at its end."""
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(size=(3, len(steps.coordinates)))
    knots = steps.normed(np.array([q + t * v + 0.5 * t * t * a for t in (-2 * h, -h, 0.0)]))
    controls = dict(zip(steps.controls, rng.normal(size=len(steps.controls)), strict=True))
    one = Instance(knots, h, h, controls)
    at = steps.at(one)
    moved = (one.v1 - one.v0) / h
    expected = at.mass[2] @ moved - at.applied[2]
    for row, name in enumerate(steps.coordinates):
        stop = f"limit.{name}"
        expected[row] -= controls.get(f"{stop}#lower", 0.0) - controls.get(f"{stop}#upper", 0.0)
    for name in steps.posted.touching:
        push = np.array([controls[f"contact.{name}.normal"], *steps.friction(name, one)])
        expected = expected - at.rows(name)[0][2].T @ push
    return np.asarray(steps.rows(one, whole=True)[0] / h - expected)
