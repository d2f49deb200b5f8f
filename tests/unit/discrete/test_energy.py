"""The balance over a step times its velocity is its energy balance, whatever the step."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from tests.support import machines
from tests.support.machines import machine
from tests.support.steps import Steps
from tests.unit.discrete.linkages import four_bar, limited

MACHINES = {
    "pendulum": machines.double_pendulum(),
    "absolute pendulum": machines.double_pendulum(angles="absolute"),
    "cart": machines.cart_pole(),
    "springs": machines.chain(),
    "absolute springs": machines.chain(angles="absolute"),
    "sliders, tendon, motors, forces": machines.crane(),
    "absolute crane": machines.crane(angles="absolute"),
    "loop, losses": four_bar(),
    "stops": limited(),
    "contacts": machines.rolling(),
    "curved ground": machines.rolling(height="0.2*sin(3*x) + 0.1*tanh(4*x) + exp(-x^2)/9"),
    "kinked ground": machines.rolling(height="max(0.1*abs(x), x - 0.3, -x^3)"),
}


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize(("h", "before"), [(0.01, 0.02), (0.3, 0.2), (0.5, 0.5)])
def test_momentum_times_velocity_is_the_energy_balance(name: str, h: float, before: float) -> None:
    """Of steps out of balance, too: the identity is of rows, not of solutions."""
    steps = Steps(MACHINES[name])
    for seed in range(3):
        one = steps.random(seed, h, before)
        momentum, _, dissipation = steps.rows(one)
        books = steps.books(one)
        gained = books.kinetic + books.potential + books.damped + books.dissipated
        scale = sum(abs(value) for value in vars(books).values())
        np.testing.assert_allclose(dissipation, books.dissipated, rtol=1e-11)
        np.testing.assert_allclose(
            momentum @ one.v1, gained - books.work - books.contact_work, atol=1e-11 * scale
        )


def test_every_kind_of_energy_was_there() -> None:
    """Or the identity would hold of nothing."""
    for name, part in {
        "sliders, tendon, motors, forces": "damped",
        "loop, losses": "work",
        "stops": "work",
        "contacts": "contact_work",
    }.items():
        steps = Steps(MACHINES[name])
        assert abs(getattr(steps.books(steps.random()), part)) > 0.01, name


def test_normal_forces_work_along_the_change_of_their_gaps() -> None:
    """One force at a time, so that none hides behind another."""
    steps = Steps(MACHINES["curved ground"])
    one = steps.random(5)
    bare = steps.rows(_with(one, {}))[0]
    for pair in steps.principle.pairs:
        pushed = steps.rows(_with(one, {f"contact.{pair}.normal": 7.0}))[0] - bare
        gap = steps.change(f"contact.{pair}.gap", one)
        np.testing.assert_allclose(pushed @ one.v1, -7.0 * gap, atol=1e-12)


def test_vertical_momentum_is_weight_and_normal_forces_exactly() -> None:
    steps = Steps(machines.rolling())
    one = steps.random(2)
    rows = dict(zip(steps.mechanism.coordinates, steps.rows(one)[0], strict=True))
    heights = steps.values(["stick#cy"], one)[0]
    speeds = np.diff(heights) / [one.before, one.h]
    push = one.controls["contact.toe.normal"] + one.controls["contact.heel.normal"]
    bare = dict(
        zip(
            steps.mechanism.coordinates,
            steps.rows(_with(one, {"contact.toe.normal": 1, "contact.heel.normal": push - 1}))[0],
            strict=True,
        )
    )
    expected = speeds[1] - speeds[0] + 9.81 * one.h - push * one.h
    np.testing.assert_allclose(bare["stick.y"], expected, rtol=1e-12)
    assert rows["stick.y"] != bare["stick.y"]  # the other pair of the toe pushed, too


def test_a_start_from_given_velocities_has_their_own_energy() -> None:
    """A step before of no length: its velocities are derivatives, not chords."""
    steps = Steps(machines.crane())
    one = steps.random(1)
    rows = np.array(
        [
            np.array(
                steps.function(one.q[1], one.v0, one.q[2], one.v1, one.h, b, one.t, _u(steps, one))[
                    0
                ]
            )
            for b in (0.0, 1e-6, 1e-5)
        ]
    )
    assert np.all(np.isfinite(rows))
    near, far = np.abs(rows[1] - rows[0]).max(), np.abs(rows[2] - rows[0]).max()
    assert 0 < near < 1e-4
    assert far == pytest.approx(10 * near, rel=0.01)


@pytest.mark.parametrize(("h", "expected"), [(0.01, 4.48), (0.02, 4.09)])
def test_a_circling_mass_loses_what_its_chord_turns(h: float, expected: float) -> None:
    """The scheme is of first order, and docs/theory.md says by how much: this is no force."""
    mass = {"mass": 1, "inertia": 0, "com": [0, 1]}
    steps = Steps(
        machine(
            {
                "gravity": [0, 0],
                "bodies": {"mass": mass},
                "joints": {"hinge": {"kind": "revolute", "child": "mass"}},
            }
        )
    )
    q0, v0, v1, before = (ca.SX.sym(name) for name in ("q0", "v0", "v1", "before"))
    none = ca.SX(0, 1)
    row = steps.function(q0, v0, q0 + h * v1, v1, h, before, 0, none)[0]
    given = {"x": v1, "p": ca.vertcat(q0, v0, before), "g": row}
    solve = ca.rootfinder("step", "newton", given)
    place, speed, length = 0.0, 5.0, 0.0
    for _ in range(round(1 / h)):
        speed = float(solve(speed, [place, speed, length]))
        place, length = place + h * speed, h
    assert speed == pytest.approx(expected, abs=0.005)
    assert speed == pytest.approx((1 / 25 + h) ** -0.5, rel=0.005)


def test_tendons_never_push() -> None:
    tendon = {
        "joint": "pull",
        "stiffness": 300,
        "rest": 0.2,
        "damping": 40,
        "pulling_only": True,
    }
    steps = Steps(
        machine(
            {
                "gravity": [0, 0],
                "bodies": {"mass": {"mass": 1e-9, "inertia": 0}},
                "joints": {"pull": {"kind": "prismatic", "child": "mass", "axis": [1, 0]}},
                "springs": {"tendon": tendon},
            }
        )
    )
    rng = np.random.default_rng(0)
    forces = []
    for _ in range(300):
        q = rng.uniform(-0.1, 0.5, size=(3, 1))
        one = _with(steps.random(h=0.05), {}, q=q)
        forces.append(-float(steps.rows(one)[0][0]) / one.h)
    assert max(forces) < 1e-6
    assert min(forces) < -50
    assert sum(force > -1e-3 for force in forces) > 50  # slack ones do nothing


def _with(one: Any, controls: dict[str, float], **more: Any) -> Any:
    return type(one)(**{**vars(one), "controls": controls, **more})


def _u(steps: Steps, one: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([one.controls[name] for name in steps.controls])
