"""The laws of impacts: momentum, cones, Newton's rebound, and energy that is never made."""

from dataclasses import replace

import numpy as np
import pytest

from solver.numeric import Array
from solver.simulation.impacts import Impact, brought_to_rest, collide
from solver.simulation.impulses import Free, Touching, free, push


def touching(Jn: Array, Jt: Array, friction: Array) -> Touching:
    none = np.zeros(len(friction))
    return Touching(Jn, Jt, none, none, friction, none)


def random_impact(rng: np.random.Generator) -> tuple[Array, Array, Touching, Array, Impact]:
    n, c = int(rng.integers(3, 9)), int(rng.integers(1, 5))
    root = rng.normal(size=(n, n))
    mass = root @ root.T + 0.1 * np.eye(n)
    Jn, Jt = rng.normal(size=(2, c, n))
    contacts = touching(Jn, Jt, rng.uniform(0, 1.5, c))
    v, bounce = rng.normal(size=n), rng.uniform(0, 1, c)
    return mass, v, contacts, bounce, collide(free(mass, mass @ v), mass, contacts, bounce)


def energy(mass: Array, v: Array) -> float:
    return float(v @ mass @ v) / 2


def test_the_laws_hold_in_hundreds_of_random_impacts() -> None:
    rng = np.random.default_rng(11)
    for _ in range(300):
        mass, v, contacts, _, found = random_impact(rng)
        change = contacts.Jn.T @ found.normal + contacts.Jt.T @ found.tangential
        np.testing.assert_allclose(mass @ (found.v - v), change, atol=1e-8)
        assert np.all(found.normal >= 0)
        assert np.all(np.abs(found.tangential) <= contacts.friction * found.normal + 1e-9)
        assert np.all(contacts.Jn @ found.v >= -1e-8)
        assert energy(mass, found.v) <= energy(mass, v) * (1 + 1e-9)


def test_friction_never_pulls() -> None:
    rng = np.random.default_rng(12)
    for _ in range(100):
        mass, v, contacts, bounce, _ = random_impact(rng)
        found = collide(free(mass, mass @ v), mass, contacts, 0 * bounce)
        assert np.all(found.tangential * (contacts.Jt @ found.v) <= 1e-8)


def ball(e: float, friction: float, v: Array) -> Impact:
    """A disc of radius 1 with I = 1/2 on level ground: x, y, angle."""
    mass = np.diag([1.0, 1.0, 0.5])
    contacts = touching(
        np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 1.0]]), np.array([friction])
    )
    return collide(free(mass, mass @ v), mass, contacts, np.array([e]))


@pytest.mark.parametrize("e", [0.0, 0.3, 1.0])
def test_a_ball_rebounds_with_its_share_of_the_speed(e: float) -> None:
    found = ball(e, 0.0, np.array([0.7, -2.0, 0.1]))
    np.testing.assert_allclose(found.v, [0.7, 2.0 * e, 0.1], atol=1e-14)
    np.testing.assert_allclose(found.normal, [2.0 * (1 + e)])


def test_a_ball_grips_where_friction_suffices() -> None:
    found = ball(0.5, 1.0, np.array([0.9, -2.0, 0.0]))
    np.testing.assert_allclose(found.v, [0.6, 1.0, -0.6], atol=1e-13)  # it rolls
    found = ball(0.5, 0.05, np.array([0.9, -2.0, 0.0]))
    np.testing.assert_allclose(found.tangential, [-0.05 * 3.0], atol=1e-13)  # it slides


def test_energy_is_not_made_where_newtons_law_would_make_it() -> None:
    # A slender rod, tipped and sliding (Kane's puzzle): by Newton's law alone energy grows.
    lean, friction = 0.6, 1.0
    mass = np.diag([1.0, 1.0, 1.0 / 12])
    Jn = np.array([[0.0, 1.0, 0.5 * np.sin(lean)]])
    Jt = np.array([[1.0, 0.0, 0.5 * np.cos(lean)]])
    contacts = touching(Jn, Jt, np.array([friction]))
    made = 0
    for slip in np.linspace(0.0, 3.0, 31):
        v = np.array([slip, -0.3, -0.5])
        motion = free(mass, mass @ v)
        rate = (Jn @ v)[0]
        rebound = np.array([min(rate, 0.0)])
        bouncing = replace(contacts, normal=rebound)
        made += energy(mass, push(motion, bouncing).x) > energy(mass, v) + 1e-9
        found = collide(motion, mass, contacts, np.array([1.0]))
        assert energy(mass, found.v) <= energy(mass, v) + 1e-12
    assert made > 0


def test_two_balls_in_a_row_hit_the_ground_at_once() -> None:
    # Simultaneous contacts: two masses on a line, the lower on the ground.
    mass = np.diag([1.0, 1.0])
    Jn = np.array([[1.0, 0.0], [-1.0, 1.0]])
    contacts = touching(Jn, np.zeros_like(Jn), np.zeros(2))
    found = collide(free(mass, mass @ np.array([-1.0, -1.0])), mass, contacts, np.zeros(2))
    np.testing.assert_allclose(found.normal, [2.0, 1.0])
    np.testing.assert_allclose(found.v, [0.0, 0.0], atol=1e-15)


def test_loops_hold_through_an_impact() -> None:
    mass, G = np.diag([1.0, 2.0, 3.0]), np.array([[1.0, -1.0, 0.0], [2.0, -2.0, 0.0]])
    v = np.array([-1.0, -1.0, 0.5])
    motion = free(mass, mass @ v, (G, np.zeros(2)))
    np.testing.assert_allclose(motion.x, v)
    contacts = touching(np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3)), np.zeros(1))
    found = collide(motion, mass, contacts, np.zeros(1))
    np.testing.assert_allclose(found.v, [0.0, 0.0, 0.5], atol=1e-14)
    np.testing.assert_allclose(found.normal, [3.0])


def test_rest_takes_the_least_energy() -> None:
    mass = np.diag([1.0, 4.0])
    rows = np.array([[1.0, 1.0], [2.0, 2.0]])
    v = brought_to_rest(Free(np.array([1.0, 0.0]), np.linalg.inv(mass)), rows)
    np.testing.assert_allclose(v, [0.2, -0.2])
