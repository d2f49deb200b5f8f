"""The audit in space: a puck that lands, slides and rests, right and wrong."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from schemas.results import Certificate, Group, PhaseResult
from solver.certificate import CHECKS, JUDGED, certify
from solver.certificate.spatial_laws import spent
from tests.support.exact import failures
from tests.support.stepped import Array, problem, published, row

MASS, MU, G = 2.0, 0.4, 9.81
KNOTS = np.linspace(0.0, 1.0, 41)
PUCK: dict[str, Any] = {
    "kind": "urdf",
    "base": "floating",
    "text": '<robot name="puck"><link name="puck"><inertial><mass value="2"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>',
    "contacts": {"spot": {"link": "puck"}},
    "ground": {"friction": MU},
    "controls": ["u"],
    "forces": {
        "push": {
            "link": "puck",
            "at": [0, 0, 0],
            "direction": [1, 0, 0],
            "value": "u",
            "frame": "world",
        }
    },
}
Law = Callable[[Array, float], Array]


def braked(stop: Array, most: float) -> Array:
    """Along x alone, which is one of the directions of the cone."""
    return np.array([np.clip(stop[0], -most, most), 0.0])


def puck(law: Law = braked, floor: float = 0.0, height: float = 0.3) -> PhaseResult:
    """From 1 m/s along x, falling; pushed along x by 12 N for half a second, then by -3 N."""
    h, places, v = float(KNOTS[1]), [np.array([0.0, 0.0, height])], np.array([1.0, 0.0, 0.0])
    push = np.where(KNOTS[1:] < 0.5, 12.0, -3.0)
    forces = []
    for u in push:
        fall = v[2] - G * h
        rise = max(fall, (floor - places[-1][2]) / h)
        normal = MASS * (rise - fall) / h
        rush = v[:2] + np.array([u, 0.0]) * h / MASS
        rub = law(-MASS * rush / h, MU * normal)
        v = np.array([*(rush + rub * h / MASS), rise])
        places.append(places[-1] + h * v)
        forces.append([normal, *rub])
    x, y, z = np.array(places).T
    turned = dict.fromkeys(("base.qx", "base.qy", "base.qz"), np.zeros(41))
    states = {"base.x": x, "base.y": y, "base.z": z, "base.qw": np.ones(41), **turned}
    starts = {f"base.d({name.partition('.')[2]})": np.zeros(1) for name in states}
    starts["base.d(x)"] = np.ones(1)
    words = ("normal", "tangential_x", "tangential_y")
    told = zip(words, np.array(forces).T, strict=True)
    named = {f"contact.spot.{word}": one for word, one in told}
    return published(KNOTS, {**states, **starts}, {"u": push}, named)


def judged(result: PhaseResult, checks: Any = JUDGED, **method: Any) -> Certificate:
    return certify(problem(PUCK, 1.0, method=method), [result], None, checks)


def changed(result: PhaseResult, name: str, step: int, by: float) -> PhaseResult:
    """One force, moved."""
    values = {key: list(row) for key, row in result.groups["forces"].values.items()}
    values[name][step] = (values[name][step] or 0.0) + by
    forces = Group(time=result.groups["forces"].time, values=values)
    return result.model_copy(update={"groups": {**result.groups, "forces": forces}})


def test_a_puck_that_lands_slides_and_sticks_passes() -> None:
    certificate = judged(puck(), CHECKS)
    assert certificate.verdict == "certified"
    found = {check.name: check.value for check in certificate.checks if check.judged}
    assert max(value or 0.0 for value in found.values()) < 1e-13
    assert {"normal work", "friction work", "energy balance", "momentum"} < set(found)
    assert row(certificate, "dissipation").value is not None


@pytest.mark.parametrize(
    ("law", "failed"),
    [
        (lambda stop, most: -braked(np.sign(stop) * 1e9, most), {"friction work"}),
        (lambda stop, most: braked(stop, most) / 2, set()),
        (lambda stop, most: braked(stop, 2 * most), set()),
        (lambda stop, most: braked(stop, most) @ np.array([[0.6, 0.4], [0, 0]]), {"friction work"}),
    ],
    ids=["along the slip", "inside of the cone", "outside of it", "across the slip"],
)
def test_friction_that_is_none(law: Law, failed: set[str]) -> None:
    assert set(failures(judged(puck(law, height=0.0)))) == {*failed, "complementarity"}


def test_ground_that_gives_way() -> None:
    failed = failures(judged(puck(floor=-1e-3)))
    assert set(failed) == {"complementarity", "penetration at knots"}


def test_an_impulse_that_did_not_act() -> None:
    resting = puck(height=0.0)
    failed = failures(judged(changed(resting, "contact.spot.normal", 39, 1.0)))
    assert set(failed) == {"momentum", "equations of motion"}
    assert failed["momentum"] == "phase move, com.pz, t = 1 s"


@pytest.mark.parametrize("count", [4, 6, 16])
def test_what_of_a_cone_is_spent(count: int) -> None:
    """Forces of size one: all of it along a direction, the most halfway between two."""
    angles = 2 * np.pi * np.arange(count) / count
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for angle in (*angles, *(angles - np.pi / count)):
        push = np.array([np.cos(angle), np.sin(angle)])
        near = np.max(directions @ push)
        expected = 1.0 if near > 1 - 1e-12 else 1 / np.cos(np.pi / count)
        assert spent(directions, push) == pytest.approx(expected)
