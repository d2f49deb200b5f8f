"""The equations of motion: against Lagrange by differences, closed forms, and virtual work."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from schemas.errors import InvalidModel
from schemas.mechanisms import Mechanism
from solver.simulation.multibody import Multibody
from tests.support.machines import cart_pole, chain, crane, double_pendulum, machine

STEP = 1e-5

Build = Callable[..., Mechanism]


def random(model: Multibody, seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(seed)
    n = len(model.coordinates)
    shape = (n, 5)
    u = generator.normal(size=(len(model.controls), 5))
    return generator.normal(size=shape), generator.normal(size=shape), u


@pytest.mark.parametrize("angles", ["relative", "absolute"])
@pytest.mark.parametrize("build", [double_pendulum, cart_pole, chain])
def test_conservative_mechanisms_obey_lagrange(build: Build, angles: str) -> None:
    model = Multibody.of(build(angles=angles))
    q, v, u = random(model)
    u[:] = 0

    def lagrangian(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        kinetic, potential = model.energy(q, v)
        return kinetic - potential

    def momenta(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        rows = []
        for one in np.eye(len(q)):
            along = one[:, None]
            rows.append((lagrangian(q, v + along) - lagrangian(q, v - along)) / 2)  # exact
        return np.array(rows)

    held = model.accelerations(np.zeros(5), q, v, u)
    rate = (
        momenta(q + STEP * v, v + STEP * held.accelerations)
        - momenta(q - STEP * v, v - STEP * held.accelerations)
    ) / (2 * STEP)
    slope = np.array(
        [
            (lagrangian(q + STEP * e[:, None], v) - lagrangian(q - STEP * e[:, None], v))
            / (2 * STEP)
            for e in np.eye(len(q))
        ]
    )
    np.testing.assert_allclose(rate, slope, atol=2e-7)


def test_the_mass_matrix_is_that_of_the_kinetic_energy() -> None:
    model = Multibody.of(crane())
    q, v, _ = random(model)
    kinetic, _ = model.energy(q, v)
    mass = model.mass(q)
    assert mass.shape == (5, len(q), len(q))
    np.testing.assert_allclose(np.einsum("nN,Nnm,mN->N", v, mass, v) / 2, kinetic, rtol=1e-13)
    assert np.all(np.linalg.eigvalsh(mass) > 0)


def test_every_force_does_the_work_of_its_place() -> None:
    model = Multibody.of(crane())
    q, v, u = random(model)
    t = np.linspace(0, 1, 5)
    at = model.at(t, q, v, u)
    driven = at.applied - at.inertial
    w = np.random.default_rng(8).normal(size=q.shape)  # a virtual velocity
    ball = model.values(["ball.x", "ball.y", "ball.angle", "ball.vx"], t, q, v, u)
    work = np.zeros(5)
    moved = model.values(["ball.vx", "ball.vy", "ball.omega"], t, q, w, u)
    arm = (0.1 + 0.2j) * np.exp(1j * ball[2])
    push = u[model.controls.index("push")]
    wind = (push - 0.2 * ball[3] ** 2) * (0.6 + 0.8j)
    place = moved[0] + 1j * moved[1] + 1j * moved[2] * arm
    work += (wind.conj() * place).real + 0.2 * push * moved[2]
    tool = model.values(["tool.angle", "tip.x", "d(swing)"], t, q, v, u)
    slid = model.values(["tool.vx", "tool.vy", "tool.omega"], t, q, w, u)
    jet = 0.3 * (tool[1] + 0.3 * tool[2]) * np.exp(1j * (tool[0] + math.pi / 4))
    place = slid[0] + 1j * slid[1] + 1j * slid[2] * (-0.3j) * np.exp(1j * tool[0])
    work += (jet.conj() * place).real
    swing, rate = model.values(["swing", "d(swing)"], t, q, v, u)
    speeds = model.values(["motor.winch.speed", "motor.turn.speed"], t, q, w, u)
    work += 3 * u[0] * speeds[0] + u[1] * speeds[1]
    work += (2 * (0.5 - swing) - 0.4 * rate - 0.1 * rate * abs(rate)) * speeds[1]
    length, pace = model.values(["spring.tendon.length", "spring.tendon.d(length)"], t, q, v, u)
    force = np.minimum(12 * (0.9 - length) - 0.6 * pace, 0) * (1 + 0.5 * np.sin(t))
    work += force * model.values(["spring.tendon.d(length)"], t, q, w, u)[0]
    np.testing.assert_allclose(np.sum(driven * w, axis=0), work, rtol=1e-12)


def test_the_cart_pole_is_that_of_the_seeds() -> None:
    model = Multibody.of(cart_pole())
    q, v, u = random(model)
    held = model.accelerations(0.0, q, v, u)
    m1, m2, rod, g = 1.0, 0.3, 0.5, 9.81
    s, c = np.sin(q[1]), np.cos(q[1])
    den = m1 + m2 * s**2
    first = (rod * m2 * s * v[1] ** 2 + u[0] + m2 * g * c * s) / den
    second = -(rod * m2 * c * s * v[1] ** 2 + u[0] * c + (m1 + m2) * g * s) / (rod * den)
    np.testing.assert_allclose(held.accelerations, [first, second], rtol=1e-12)


def test_gravity_alone_moves_the_momentum() -> None:
    model = Multibody.of(chain())
    q, v, u = random(model)
    held = model.accelerations(0.0, q, v, u)
    ahead = model.momentum(q + STEP * v, v + STEP * held.accelerations)
    behind = model.momentum(q - STEP * v, v - STEP * held.accelerations)
    rate = (ahead - behind) / (2 * STEP)
    expected = np.array([2.4 * 0.3, 2.4 * -9.81, 0.0])[:, None] * np.ones(5)
    np.testing.assert_allclose(rate, expected, atol=1e-7)
    named = model.values(["com.px", "com.py", "com.spin"], 0.0, q, v, u)
    np.testing.assert_array_equal(named, model.momentum(q, v))


def test_a_motor_with_losses_follows_the_notes() -> None:
    losses = {
        "constant": 0.5,
        "coulomb": 0.1,
        "viscous": 0.02,
        "friction": 0.3,
        "resistance": 1.3,
        "brush": 0.7,
        "smoothing": 1e-3,
    }
    model = Multibody.of(double_pendulum(motors={"m": {"joint": "elbow", "losses": losses}}))
    assert model.controls == ("motor.m.current",)
    current, speed = -2.0, 3.0
    q, v = np.zeros(2), np.array([1.0, speed])
    torque, power = model.values(
        ["motor.m.torque", "motor.m.power"], 0.0, q, v, np.array([current])
    )
    # 003, equations 2.1 and 2.2
    assert torque == pytest.approx(0.5 * -2 - 0.02 * 3 - (0.1 + 0.3 * 0.5 * 2))
    assert power == pytest.approx((-2 * 1.3 + 0.7 + 0.5 * 3) * -2)
    passive = model.accelerations(0.0, q, v, np.array([0.0]))
    assert passive.accelerations.shape == (2,)


def test_parameters_and_statics_are_numbers_of_the_model() -> None:
    document = double_pendulum().model_dump(mode="json")
    document["bodies"]["lower"]["mass"] = "heavy"
    model = Multibody.of(machine(document), {"heavy": 7.0})
    assert model.parts.masses.tolist() == [1.3, 7.0]


def test_a_force_cannot_use_what_it_makes() -> None:
    looped = {"joint": "elbow", "value": "-0.1*dd(elbow)"}
    with pytest.raises(InvalidModel, match=r"dd\(elbow\)"):
        Multibody.of(double_pendulum(torques={"looped": looped}))


def test_points_of_any_shape_come_back_in_it() -> None:
    model = Multibody.of(double_pendulum())
    q = np.random.default_rng(0).normal(size=(2, 3, 4))
    t = np.zeros((3, 4))
    held = model.accelerations(t, q, 0.5 * q, np.zeros((0, 3, 4)))
    assert held.accelerations.shape == (2, 3, 4)
    one = model.accelerations(0.0, q[:, 1, 2], 0.5 * q[:, 1, 2], np.zeros(0))
    np.testing.assert_allclose(one.accelerations, held.accelerations[:, 1, 2], rtol=1e-13)
    assert model.frames(q).shape == (2, 3, 3, 4)
    assert model.forces(t, q, q, np.zeros((0, 3, 4))).shape == (3, 4, 2)
