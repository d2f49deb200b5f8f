"""URDF dynamics against pinocchio (``pin`` on PyPI) on robots that ``example-robot-data`` ships.

Inverse dynamics, mass matrix, energies, centre of mass and momenta at random states, to 1e-10; of
the engine's trees and of the judge's own bodies alike. The texts stay where the package has them.
"""

from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from schemas.urdf import Urdf
from solver.simulation.spatial import SpatialMultibody
from tests.support.pinned import pinned
from tests.support.robots import equations, evaluated, system

pin = pytest.importorskip("pinocchio", reason="pin is not installed: pip install '.[dev]'")

ROBOTS = (
    "solo12.urdf",
    "anymal_b_simple_description/robots/anymal.urdf",
    "hyq_no_sensors.urdf",
    "go2.urdf",
    "simple_humanoid.urdf",
    "talos_reduced.urdf",
    "talos_full_v2.urdf",  # twelve joints that mimic, on one
    "g1_29dof_rev_1_0.urdf",
    "romeo_small.urdf",
    "centauro.urdf",
    "panda.urdf",  # sliding fingers, one mimics the other
    "ur5_robot.urdf",
    "kinova.urdf",
    "pr2.urdf",
    "double_pendulum.urdf",
)
BOTH = [(name, base) for name in ROBOTS for base in ("fixed", "floating") if "ur5" not in name]
NAMES = [
    *("energy.kinetic", "energy.potential", "com.x", "com.y", "com.z", "com.vx", "com.vy"),
    *("com.px", "com.py", "com.pz", "com.spin_x", "com.spin_y", "com.spin_z"),
]


@cache
def texts() -> dict[str, Path]:
    found = metadata.files("example-robot-data") or []
    return {str(path): Path(str(path.locate())) for path in found if path.suffix == ".urdf"}


def text(name: str) -> str:
    return next(path for key, path in texts().items() if key.endswith(name)).read_text()


@pytest.mark.parametrize(("name", "base"), [*BOTH, ("ur5_robot.urdf", "fixed")])
def test_dynamics_are_those_of_pinocchio(name: str, base: str) -> None:
    one = system(text(name), base=base)
    root = (pin.JointModelFreeFlyer(),) if base == "floating" else ()
    model = pin.buildModelFromXML(text(name), *root)
    rng = np.random.default_rng(1)
    _, tape = equations(one, NAMES)
    for _ in range(2):
        q, v, a = rng.normal(size=(3, len(one.coordinates)))
        _compare(one, model, tape, q, v, a)


def _compare(one: Urdf, model: Any, tape: Any, q: Any, v: Any, a: Any) -> None:
    n, data, state = len(q), model.createData(), pinned(pin, model, one, q, v, a)
    effort = pin.rnea(model, data, state.q, state.v, state.a) + state.damping * state.v
    mass = pin.crba(model, data, state.q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    # columns: the motion itself, no accelerations, and each coordinate's alone
    several = np.column_stack([a, np.zeros(n), np.eye(n)])
    still = np.zeros((len(one.control_names) + 2, n + 2))
    found = evaluated(tape, *(np.repeat(b[:, None], n + 2, axis=1) for b in (q, v)), several, still)
    rows = found[:n][state.rows]
    close(rows[:, 0], (state.acts @ effort)[state.rows])
    close(rows[:, 2:] - rows[:, 1:2], (state.acts @ mass @ state.moves)[state.rows])
    expected = _whole(model, data, state)
    close(found[n:, 0], expected)
    judge = SpatialMultibody.of(one)
    drive = np.zeros(len(judge.controls))
    close(judge.values(NAMES, 0.0, q, v, drive), expected)
    close(judge.mass(q), state.moves.T @ mass @ state.moves)
    solved = judge.accelerations(0.0, q, v, drive).accelerations
    again = pinned(pin, model, one, q, v, solved)
    free = pin.rnea(model, data, again.q, again.v, again.a) + again.damping * again.v
    close((again.acts @ free)[state.rows] / (1 + np.abs(effort).max()), np.zeros(len(state.rows)))


def _whole(model: Any, data: Any, state: Any) -> Any:
    kinetic = pin.computeKineticEnergy(model, data, state.q, state.v)
    potential = pin.computePotentialEnergy(model, data, state.q)
    pin.centerOfMass(model, data, state.q, state.v)
    momentum = pin.computeCentroidalMomentum(model, data, state.q, state.v)
    whole = [*data.com[0], *data.vcom[0][:2], *momentum.linear, *momentum.angular]
    return np.array([kinetic, potential, *whole])


def close(ours: Any, theirs: Any) -> None:
    assert np.abs(ours - theirs).max() <= 1e-10 * (1 + np.abs(theirs).max())
