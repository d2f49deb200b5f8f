"""The names that a mechanism brings along: every one of them, against the judge and differences."""

import numpy as np
import pytest

from schemas.expressions import derivative, stem
from schemas.expressions.names import MAX_ORDER
from solver.simulation.multibody import Multibody
from tests.support.lowered import Lowered
from tests.support.machines import Build, chain, crane, machine

STEP = 1e-5


def moved(low: Lowered, at: dict[str, np.ndarray], by: float) -> dict[str, np.ndarray]:
    """The same motion a little later: coordinates and velocities along their rates."""
    later = dict(at) | {"t": at["t"] + by}
    for name in low.mechanism.coordinates:
        v, a = at[derivative(name)], at[derivative(name, 2)]
        later[name] = at[name] + by * v + by**2 * a / 2
        later[derivative(name)] = v + by * a
    return later


@pytest.mark.parametrize("angles", ["relative", "absolute"])
@pytest.mark.parametrize("build", [chain, crane])
def test_every_name_has_its_value_and_its_rate(build: Build, angles: str) -> None:
    low = Lowered(build(angles=angles))
    at = low.random()
    at |= {derivative(name): np.zeros(6) for name in low.mechanism.control_names}
    names = [name for name, order in low.mechanism.defined.items() if order >= MAX_ORDER - 1]
    values = dict(zip(names, low(names, at), strict=True))
    rates = low([derivative(name) for name in names], at)
    ahead, behind = (low(names, moved(low, at, by)) for by in (STEP, -STEP))
    np.testing.assert_allclose(rates, (ahead - behind) / (2 * STEP), rtol=1e-6, atol=1e-6)
    judged = Multibody.of(low.mechanism)
    kinetic, potential = judged.energy(low.stacked(at), low.stacked(at, 1), at["t"])
    np.testing.assert_allclose(values["energy.kinetic"], kinetic, rtol=1e-12)
    np.testing.assert_allclose(values["energy.potential"], potential, rtol=1e-12)
    momentum = judged.momentum(low.stacked(at), low.stacked(at, 1))
    told = [values[name] for name in ("com.px", "com.py", "com.spin")]
    np.testing.assert_allclose(told, momentum, rtol=1e-12, atol=1e-12)


def test_velocities_by_name_are_derivatives_of_places() -> None:
    low = Lowered(crane())
    at = low.random()
    told = low(["tip.vx", "tip.vy", "ball.omega", "com.vx", "bridge.omega"], at)
    expected = low(["tip.d(x)", "tip.d(y)", "ball.d(angle)", "com.d(x)", "bridge.d(angle)"], at)
    np.testing.assert_array_equal(told, expected)
    assert not told[-1].any()  # it slides and does not turn


def test_without_springs_and_gravity_the_momentum_stays() -> None:
    low = Lowered(chain(gravity=[0, 0], springs={}))
    at = low.random()
    rows = low([f"#dynamics {name}" for name in low.mechanism.coordinates[:2]], at)
    rates = low(["com.d(px)", "com.d(py)"], at)
    np.testing.assert_allclose(rows, rates, rtol=1e-11)  # what floats is pushed by nothing else


def test_the_spring_pushes_apart_and_a_tendon_only_pulls() -> None:
    spring = {"between": [{"body": "ground"}, {"body": "ball"}], "stiffness": 10, "rest": 1}
    low = Lowered(
        machine(
            {
                "gravity": [0, 0],
                "bodies": {"ball": {"mass": 1, "inertia": 1}},
                "joints": {"free": {"kind": "floating", "child": "ball"}},
                "springs": {"spring": spring, "tendon": {**spring, "pulling_only": True}},
            }
        )
    )
    at = {name: np.zeros(2) for name in low.inputs} | {"ball.x": np.array([0.5, 1.5])}
    names = ["spring.spring.length", "spring.spring.force", "spring.tendon.force"]
    found = low([*names, "#dynamics ball.x", "energy.potential"], at)
    np.testing.assert_allclose(found[0], [0.5, 1.5])
    np.testing.assert_allclose(found[1], [5, -5])
    np.testing.assert_allclose(found[2], [0, -5])
    np.testing.assert_allclose(found[3], [-5, 10])
    np.testing.assert_allclose(found[4], [1.25, 2.5])


def arm(**motor: object) -> Lowered:
    return Lowered(
        machine(
            {
                "gravity": [0, 0],
                "bodies": {"arm": {"mass": 1, "inertia": 1}},
                "joints": {"hinge": {"kind": "revolute", "child": "arm"}},
                "motors": {"hinge": {"joint": "hinge", **motor}},
            }
        )
    )


def test_a_gear_multiplies_the_torque() -> None:
    low = arm(gear=3)
    at = {name: np.full(1, 2.0) for name in low.inputs}
    row, speed, power = low(["#dynamics hinge", "motor.hinge.speed", "motor.hinge.power"], at)
    assert row == pytest.approx(2.0 - 3 * 2.0)
    assert speed == pytest.approx(2.0)
    assert power == pytest.approx(3 * 2.0 * 2.0)


def test_a_motor_with_losses_draws_more_than_it_gives() -> None:
    """003, equations 2.1 and 2.2: written out by hand."""
    km, c0, c1, mu, r, vc = 0.5, 0.1, 0.02, 0.05, 1.3, 0.7
    low = arm(
        losses={
            "constant": km,
            "coulomb": c0,
            "viscous": c1,
            "friction": mu,
            "resistance": r,
            "brush": vc,
            "smoothing": 0.1,
        }
    )
    assert low.mechanism.control_names == ["motor.hinge.current"]
    at = low.random(5)
    current, speed = at["motor.hinge.current"], at["d(hinge)"]
    side = np.tanh(speed / 0.1)
    torque = km * current - c1 * speed - (c0 + mu * km * np.abs(current)) * side
    power = (current * r + side * vc + km * speed) * current
    names = ["motor.hinge.torque", "motor.hinge.power", "#dynamics hinge"]
    np.testing.assert_allclose(low(names, at), [torque, power, at["dd(hinge)"] - torque])


def test_statics_may_be_masses_and_lengths() -> None:
    body = {"mass": "m", "inertia": "m*l^2/3", "com": ["l/2", 0]}
    system = machine(
        {
            "bodies": {"arm": body},
            "joints": {"hinge": {"kind": "revolute", "child": "arm", "at": ["l", 0]}},
        }
    )
    low = Lowered(system, {"m": 2.0, "l": 0.5})
    at = low.random(3)
    expected = (2 * 0.25 / 3 + 2 * 0.0625) * at["dd(hinge)"] + 2 * 9.81 * 0.25 * np.cos(at["hinge"])
    np.testing.assert_allclose(low(["#dynamics hinge"], at)[0], expected, rtol=1e-12)


def test_no_name_is_left_without_a_tree() -> None:
    low = Lowered(crane())
    told = low(list(low.mechanism.defined), low.random())
    assert np.isfinite(told).all()
    assert all(stem(name)[0] == 0 for name in low.mechanism.defined)
