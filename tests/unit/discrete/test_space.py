"""Steps in space: their balance times their velocity is their energy balance, whatever the step."""

import functools
import itertools

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solver.numeric.tape import Array
from tests.support.spatial_steps import Instance, SpatialRows
from tests.unit.discrete.spatial_systems import SYSTEMS


@functools.cache
def made(name: str) -> SpatialRows:
    return SpatialRows(SYSTEMS[name])


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("h", "before"), [(0.3, 0.2), (1e-3, 0.1), (0.5, 1e-2)])
def test_forces_do_the_work_that_they_should(name: str, seed: int, h: float, before: float) -> None:
    """Out of balance, too: what is left over times the velocity is what is missing."""
    steps = made(name)
    one = steps.random(seed, h, before)
    momentum, _, dissipation = steps.rows(one, whole=True)
    books = steps.books(one)
    gained = books.kinetic + books.potential + books.damped + books.dissipated
    put_in = books.drives + books.forces + books.normal + books.friction + books.stops
    scale = sum(abs(value) for value in vars(books).values())
    np.testing.assert_allclose(dissipation, books.dissipated, rtol=1e-10)
    np.testing.assert_allclose(momentum @ one.v1, gained - put_in, atol=1e-11 * scale)


def test_bodies_turned_far() -> None:
    """By more than small angles, and by less than half a turn."""
    for name, least in {"pendulum": 0.2, "box": 0.5, "tree": 1.0, "loose": 1.0}.items():
        steps = made(name)
        turns = []
        for seed in range(3):
            for _, _, _, axes in steps.bodies(steps.at(steps.random(seed))):
                relative = Rotation.from_matrix(np.swapaxes(axes[:-1], 1, 2) @ axes[1:])
                turns += relative.magnitude().tolist()
        assert least < max(turns) < 2.5, name


def test_every_kind_of_energy_was_there() -> None:
    """Or the identity would hold of nothing."""
    steps = made("tree")
    books = vars(steps.books(steps.random()))
    assert min(abs(value) for value in books.values()) > 0.01


@pytest.mark.parametrize("name", ["box", "tree", "loose"])
def test_three_rows_of_a_quaternion_say_all_that_works(name: str) -> None:
    """What they leave out is along the mean of both ends, at right angles to the change."""
    steps = made(name)
    one = steps.random(4)
    whole, kept = steps.rows(one, whole=True)[0], steps.rows(one)[0]
    for first in steps.posted.balls:
        at = steps.coordinates.index(first)
        q0, q1 = one.q[1:, at : at + 4]
        p = (q0 + q1) / 2
        w, x, y, z = p
        across = np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
        np.testing.assert_allclose(across @ p, 0, atol=1e-15)
        np.testing.assert_allclose(across @ across.T, p @ p * np.eye(3), atol=1e-15)
        np.testing.assert_allclose(kept[at + 1 : at + 4], across @ whole[at : at + 4], atol=1e-13)
        assert kept[at] == pytest.approx(q1 @ q1 - 1, abs=1e-14)
        work = kept[at + 1 : at + 4] @ across @ (q1 - q0) / (p @ p)
        assert work == pytest.approx(whole[at : at + 4] @ (q1 - q0), rel=1e-10)


@pytest.mark.parametrize("name", ["ball", "tree"])
def test_normal_forces_work_along_the_change_of_their_gaps(name: str) -> None:
    steps = made(name)
    one = steps.random(5)
    at = steps.at(one)
    bare = steps.rows(Instance(one.q, one.before, one.h, {}), whole=True)[0]
    for contact in steps.posted.touching:
        force = {f"contact.{contact}.normal": 7.0}
        pushed = steps.rows(Instance(one.q, one.before, one.h, force), whole=True)[0] - bare
        change = at.gap(contact)[2] - at.gap(contact)[1]
        assert pushed @ one.v1 == pytest.approx(-7.0 * change, abs=1e-12)


def test_the_momentum_of_a_free_system_is_weight_and_contacts_exactly() -> None:
    steps = made("tree")
    one = steps.random(2)
    at = steps.at(one)
    speeds = np.diff(at.com, axis=0) / [[one.before], [one.h]]
    mass, get = at.mass_total, one.controls.get
    force = mass * steps.model.numbers.gravity
    for name in steps.posted.touching:
        x, y = steps.friction(name, one)
        force = force + np.array([x, y, get(f"contact.{name}.normal", 0.0)])
    along = at.frames["skew"].axes[2] @ steps.model.numbers.directions["push"]
    force = force + along * (2 * one.controls["u"] + 1)
    rows = dict(zip(steps.coordinates, steps.rows(one)[0], strict=True))
    expected = mass * (speeds[1] - speeds[0]) - one.h * force
    found = [rows[name] for name in ("base.x", "base.y", "base.z")]
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def tumbled(spin: tuple[float, float, float], count: int = 30, h: float = 0.05) -> list[Instance]:
    """Steps of a free body that falls, from a spin in its own axes, rad/s."""
    steps = made("box")
    q0, v0, v1 = (ca.SX.sym(name, 7) for name in ("q0", "v0", "v1"))
    before, push = ca.SX.sym("before"), {"u": -0.5}  # of a force 2 u + 1
    u = [push.get(name, 0.0) for name in steps.controls]
    row = steps.function(q0, v0, q0 + h * v1, v1, h, before, u)[0]
    solve = ca.rootfinder("step", "newton", {"x": v1, "p": ca.vertcat(q0, v0, before), "g": row})
    q, v, length, found = np.array([0, 0, 0, 1.0, 0, 0, 0]), np.zeros(7), 0.0, list[Instance]()
    v[4:] = np.array(spin) / 2
    for _ in range(count):
        speed = np.array(solve(v, np.concatenate([q, v, [length]]))).ravel()
        found.append(Instance(np.array([q - h * v, q, q + h * speed]), h, h, push))
        q, v, length = q + h * speed, speed, h
    return found[1:]


def spun(one: Instance) -> tuple[list[Array], list[float]]:
    """The angular momentum in the world, and what energy it has, of two steps of a body."""
    steps = made("box")
    ((_, inertia, _, axes),) = steps.bodies(steps.at(one))
    turns = Rotation.from_matrix(np.swapaxes(axes[:-1], 1, 2) @ axes[1:]).as_rotvec()
    spins = turns / [[one.before], [one.h]]
    momenta = [R @ inertia @ w for R, w in zip(axes[1:], spins, strict=True)]
    return momenta, [float(w @ inertia @ w) / 2 for w in spins]


def test_a_tumbling_body_keeps_its_angular_momentum() -> None:
    """Exactly, about all axes, by turns of half a radian; its energy can only fall."""
    steps = tumbled((7.0, -3.0, 5.0))
    first, _ = spun(steps[0])
    momenta, energies = zip(*(spun(one) for one in steps), strict=True)
    for pair in momenta:
        np.testing.assert_allclose(pair, [first[0]] * 2, atol=1e-12)
    levels = [pair[1] for pair in energies]
    assert all(a >= b - 1e-13 for a, b in itertools.pairwise(levels))
    assert levels[-1] < levels[0] - 1e-4


def test_a_steady_spin_about_a_principal_axis_loses_nothing() -> None:
    steps = made("box")
    ((_, inertia, _, _),) = steps.bodies(steps.at(steps.random()))
    _, axes = np.linalg.eigh(inertia)
    x, y, z = (9.0 * axes[:, 0]).tolist()
    _, last = spun(tumbled((x, y, z))[-1])
    assert last[1] == pytest.approx(81 / 2 * np.linalg.eigvalsh(inertia)[0], rel=1e-10)
