"""Damped tendons: the audit passes the engine's own steps through slack, and no other pull."""

from typing import Any

import numpy as np
import pytest
import scipy.optimize

from schemas.mechanisms import Mechanism
from schemas.results import Certificate, PhaseResult
from solver.certificate import JUDGED, certify
from tests.support.exact import failures
from tests.support.stepped import problem, published, row
from tests.support.steps import Instance, Steps

KNOTS = np.linspace(0.0, 0.9, 46)
REST = 0.5


def hanging(**tendon: Any) -> dict[str, Any]:
    """A mass below a tendon of 0.5 m, with ``z`` downward."""
    spring = {"joint": "z", "rest": REST, "pulling_only": True, "stiffness": 500.0, **tendon}
    return {
        "kind": "mechanism",
        "bodies": {"bob": {"mass": 1.5, "inertia": 0.1}},
        "joints": {"z": {"kind": "prismatic", "axis": [0, -1], "child": "bob"}},
        "springs": {"tendon": spring},
    }


def stepped(system: dict[str, Any], start: float, speed: float) -> PhaseResult:
    """By the engine's own rows, each step solved; where it starts and how fast, m and m/s."""
    rows = Steps(_mechanism(system))
    h = float(KNOTS[1])
    z = [start - h * speed, start]
    for _ in KNOTS[1:]:

        def left(after: float, before: tuple[float, ...] = tuple(z[-2:])) -> float:
            one = Instance(np.array([[*before, after]]).T, h, h, {})
            return float(rows.rows(one)[0][0])

        z.append(scipy.optimize.brentq(left, z[-1] - 1.0, z[-1] + 1.0, xtol=1e-15))
    states = {"z": np.array(z[1:]), "d(z)": np.array([speed])}
    return published(KNOTS, states, {}, {})


def _mechanism(system: dict[str, Any]) -> Mechanism:
    found = problem(system, 1.0).phases[0].system
    assert isinstance(found, Mechanism)
    return found


def judged(system: dict[str, Any], result: PhaseResult) -> Certificate:
    return certify(problem(system, float(KNOTS[-1])), [result], None, JUDGED)


def taut(result: PhaseResult) -> list[bool]:
    """At which knots the tendon is stretched."""
    return [z is not None and z > REST for z in result.groups["states"].values["z"]]


@pytest.mark.parametrize("stiffness", [500.0, 2e5])
@pytest.mark.parametrize("damping", [0.0, 4.0, 60.0])
def test_a_mass_that_falls_into_its_tendon_passes(stiffness: float, damping: float) -> None:
    """It is thrown up, falls, and is caught: the tendon gets taut within a step."""
    right = stepped(hanging(stiffness=stiffness, damping=damping), 0.35, -1.0)
    assert 0 < sum(taut(right)) < len(KNOTS)
    passes(hanging(stiffness=stiffness, damping=damping), right)


def test_a_damper_that_only_pulls_passes() -> None:
    """Up it does nothing, down it brakes."""
    system = hanging(stiffness=0.0, damping=60.0)
    right = stepped(system, 0.35, -1.0)
    passes(system, right)
    speeds = np.array(right.groups["states"].values["d(z)"], dtype=float)
    assert speeds[0] + 9.81 * KNOTS[5] == pytest.approx(speeds[5])
    assert speeds[-1] == pytest.approx(1.5 * 9.81 / 60.0, rel=1e-3)


def passes(system: dict[str, Any], right: PhaseResult) -> None:
    """To round-off."""
    certificate = judged(system, right)
    assert certificate.verdict == "certified"
    for name in ("energy balance", "momentum", "equations of motion"):
        assert (row(certificate, name).value or 0.0) < 1e-10


@pytest.mark.parametrize("wrong", [{"damping": 4.4}, {"stiffness": 505.0}, {"rest": 0.501}])
def test_steps_of_another_tendon_fail(wrong: dict[str, float]) -> None:
    right = hanging(damping=4.0)
    other = stepped({**right, "springs": hanging(**{"damping": 4.0, **wrong})["springs"]}, 0.35, 0)
    assert {"energy balance", "equations of motion"} <= set(failures(judged(right, other)))


def test_a_damper_that_pushes_fails() -> None:
    """As that of a spring does: where a tendon shortens fast, there is nothing to push with."""
    tendon, spring = hanging(damping=60.0), hanging(damping=60.0, pulling_only=False)
    pushed = stepped(spring, 0.52, -3.0)
    assert taut(pushed)[:2] == [True, False]
    assert {"energy balance", "equations of motion"} <= set(failures(judged(tendon, pushed)))
