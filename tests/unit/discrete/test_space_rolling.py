"""Spheres roll on level ground without slip, by the angle and not by its sine."""

import numpy as np
import pytest

from solver.numeric.tape import Array
from tests.support.spatial_steps import Instance, SpatialRows
from tests.unit.discrete.spatial_systems import SYSTEMS, ball

RADIUS = 0.3
STEPS = SpatialRows(ball(RADIUS))
START = np.array([0.5, -0.1, 0.7, 0.5]) / np.linalg.norm([0.5, -0.1, 0.7, 0.5])


def turned(vector: Array) -> Array:
    """The start, turned about a vector of the world by its length, rad."""
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle else vector
    w, v = np.cos(angle / 2), np.sin(angle / 2) * axis
    s, u = START[0], START[1:]
    return np.array([w * s - v @ u, *(w * u + s * v + np.cross(v, u))])


def slip(velocity: Array, spin: Array, h: float) -> Array:
    """Along x and y, m/s, of a ball that turns evenly about its middle, which goes straight."""
    middle = np.array([0.1, -0.4, 0.9])
    q = np.array([[*(middle + t * velocity), *turned(t * spin)] for t in (-0.1, 0.0, h)])
    return STEPS.rows(Instance(q, 0.1, h, {}))[1]


@pytest.mark.parametrize("angle", [1e-9, 1e-3, 0.06, 0.5, 1.5, 2.4])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0.6, -0.8, 0), (0.5, 0.5, 1), (-0.1, 0.3, -2)])
def test_a_ball_rolls_without_slip(angle: float, axis: tuple[float, float, float]) -> None:
    """It may spin about the normal as well."""
    h, spin = 0.25, angle / 0.25 * np.array(axis) / np.linalg.norm(axis)
    velocity = np.cross(spin, [0, 0, RADIUS])
    assert np.abs(slip(velocity, spin, h)).max() < 1e-13 * max(1.0, angle / h)
    skid = np.array([0.7, -0.3, 0.2])
    np.testing.assert_allclose(slip(velocity + skid, spin, h), skid[:2], atol=1e-12)
    np.testing.assert_allclose(slip(skid * 0, spin, h), -velocity[:2], atol=1e-12)


@pytest.mark.parametrize("name", ["ball", "tree", "planar tree"])
def test_slips_are_the_simulators_own_in_small_steps(name: str) -> None:
    """To first order, whatever the motion."""
    steps = SpatialRows(SYSTEMS[name])
    q, v = np.random.default_rng(4).normal(size=(2, len(steps.coordinates)))
    errors = []
    for h in (1e-3, 1e-4):
        one = Instance(steps.normed(np.array([q - h * v, q, q + h * v])), h, h, {})
        at = steps.at(one)
        expected = np.concatenate([at.slip(contact)[2] for contact in steps.posted.touching])
        errors.append(np.abs(steps.rows(one)[1] - expected).max())
    assert errors[0] < 0.1
    assert errors[1] < 0.15 * errors[0]
