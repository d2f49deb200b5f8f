"""The audit of bodies that turn in space: its own rows and books, and what they find."""

import functools
from typing import Any

import casadi as ca
import numpy as np
import pytest

from schemas import resolve
from schemas.results import Certificate, PhaseResult
from schemas.urdf import Urdf
from solver.certificate import certify
from solver.certificate.published import Published
from solver.certificate.spatial_averages import spatial_averaged
from solver.certificate.spatial_energies import spatial_energies
from solver.certificate.spatial_steps import SpatialSteps
from tests.support.exact import failures
from tests.support.robots import joint, link, robot
from tests.support.spatial_steps import METHOD, Instance, SpatialRows
from tests.support.stepped import Array, problem, published, rate, row
from tests.unit.discrete.spatial_systems import SYSTEMS

DUMBBELL: dict[str, Any] = {
    "kind": "urdf",
    "base": "floating",
    "text": robot(
        link("body", 2.0),
        link("arm"),
        joint("elbow", "continuous", "body", "arm", "<axis xyz='0 1 0'/>"),
    ),
    "motors": ["elbow"],
}  # fmt: skip


def audited(steps: SpatialRows, one: Instance) -> SpatialSteps:
    """A step at random as two published ones, of which the first has no forces."""
    get, forces = one.controls.get, dict[str, float]()
    for name in steps.posted.touching:
        x, y = steps.friction(name, one)
        forces |= {f"contact.{name}.tangential_x": x, f"contact.{name}.tangential_y": y}
        forces[f"contact.{name}.normal"] = get(f"contact.{name}.normal", 0.0)
    for name in steps.coordinates:
        lower, upper = (get(f"limit.{name}#{side}", 0.0) for side in ("lower", "upper"))
        forces[f"limit.{name}"] = lower - upper
    knots = np.array([0.0, one.before, one.before + one.h])
    v = np.stack([one.v0, one.v0, one.v1], axis=1)
    names = steps.posted.control_names
    u = np.reshape([[0.0, get(name, 0.0)] for name in names], (len(names), 2))
    told = {name: np.array([0.0, value]) for name, value in forces.items()}
    told_steps = Published(knots, one.q.T, v, u, told)
    return SpatialSteps(steps.model, METHOD, told_steps, resolve.parameters(steps.posted))


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("seed", range(2))
def test_rows_are_the_steps_own(name: str, seed: int) -> None:
    """Whatever the step, with another arithmetic: all that the method says, and no more."""
    steps = SpatialRows(SYSTEMS[name])
    one = steps.random(seed)
    found = audited(steps, one)
    balance = spatial_averaged(found)
    whole = steps.rows(one, whole=True)[0]
    for first in steps.posted.balls:
        at = slice(steps.coordinates.index(first), steps.coordinates.index(first) + 4)
        p = one.q[1:, at].mean(axis=0)
        whole[at] -= p * (p @ whole[at]) / (p @ p)
    sizes = float(balance.sizes[:, 1].max())
    np.testing.assert_allclose(-balance.left[:, 1], whole, atol=1e-12 * sizes)
    left = spatial_energies(found).left[1]
    assert left == pytest.approx(whole @ one.v1, abs=1e-12 * sizes * np.abs(one.v1).max())


@functools.cache
def swung(count: int = 20, h: float = 0.04) -> PhaseResult:
    """A body and its arm tumble, driven at the elbow: by steps of the discrete gradient."""
    steps = SpatialRows(Urdf.model_validate(DUMBBELL))
    size = len(steps.coordinates)
    q0, v0, v1 = (ca.SX.sym(name, size) for name in ("q0", "v0", "v1"))
    before, torque = ca.SX.sym("before"), ca.SX.sym("torque")
    u = [torque if name == "motor.elbow.torque" else 0.0 for name in steps.controls]
    rows = steps.function(q0, v0, q0 + h * v1, v1, h, before, ca.vertcat(*u))[0]
    given = {"x": v1, "p": ca.vertcat(q0, v0, before, torque), "g": rows}
    solve = ca.rootfinder("step", "newton", given)
    q, v = [np.eye(size)[3]], np.array([0.1, 0.2, 0, 0, 1.0, -0.5, 0.7, 0.6])
    start, length, torques = v, 0.0, 0.3 * np.sin(np.arange(count))
    for one in torques:
        v = np.array(solve(v, np.concatenate([q[-1], v, [length, one]]))).ravel()
        q.append(q[-1] + h * v)
        length = h
    states = dict(zip(steps.coordinates, np.array(q).T, strict=True))
    rates = {rate(name): start[[i]] for i, name in enumerate(steps.coordinates)}
    knots = np.array([h * k for k in range(count + 1)])
    return published(knots, {**states, **rates}, {"motor.elbow.torque": torques}, {})


def judged(result: PhaseResult, **method: Any) -> Certificate:
    return certify(problem(DUMBBELL, 0.8, method=method), [result], None)


def moved(result: PhaseResult, name: str, by: Array) -> PhaseResult:
    """The same forces, and another motion, whose rates are its own."""
    groups = result.groups
    states = {key: np.array(one) for key, one in groups["states"].values.items()}
    own = {key: one for key, one in states.items() if rate(key) in states}
    own[name] = own[name] + by
    starts = {rate(key): states[rate(key)][:1] for key in own}
    controls = {key: np.array(one) for key, one in groups["controls"].values.items()}
    return published(np.array(result.knots), {**own, **starts}, controls, {})


def test_a_tumbling_robot_passes() -> None:
    certificate = judged(swung())
    assert certificate.verdict == "certified"
    for name, most in {
        "energy balance": 1e-12,
        "momentum": 1e-5,
        "equations of motion": 1e-5,
    }.items():
        value = row(certificate, name).value
        assert value is not None
        assert value < most  # along x and y nothing else pushes


def test_the_same_steps_are_none_of_backward_euler() -> None:
    failed = failures(judged(swung(), discretisation="backward_euler"))
    assert set(failed) == {"energy balance", "equations of motion"}


def test_an_arm_that_goes_ahead_of_its_motor() -> None:
    wave = 1e-3 * np.sin(np.arange(21)) * (np.arange(21) > 1)
    failed = failures(judged(moved(swung(), "elbow", wave)))
    assert set(failed) == {"energy balance", "momentum", "equations of motion"}
