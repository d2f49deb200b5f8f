"""What the audit tells and does not judge; names and figures of phases of steps."""

from typing import Any

import numpy as np
import pytest

from schemas.results import Certificate, PhaseResult
from solver.certificate import JUDGED, certify
from solver.certificate.case import Case
from solver.certificate.losses import lost_per_step
from tests.support.exact import failures
from tests.support.stepped import Array, problem, row
from tests.support.steps_by_hand import ARM, BLOCK, G, arm, block

DROP = (0.0, 0.3, 1.0, 0.0)


def steps(count: int) -> Array:
    return np.linspace(0.0, 1.0, count + 1)


def dropped(count: int = 40) -> PhaseResult:
    return block(steps(count), DROP, np.where(steps(count)[1:] < 0.5, 12.0, -3.0))


def test_what_an_impact_takes_is_no_dissipation_of_the_method() -> None:
    """A fall of half a metre onto the ground, then a push along it, from rest to 1 m/s."""
    knots = steps(50)
    pushed = block(knots, (0.0, 0.5, 0.0, 0.0), np.where(knots[1:] > 0.5, 2 * G * 0.4 + 4.0, 0.0))
    case = Case.open(problem(BLOCK, 1.0), [pushed], None, {})
    landing, fallen = np.sqrt(2 * 0.5 / G), 2 * G * 0.5
    lost = lost_per_step(case.stepped[0])
    h = knots[1]
    # Half of m dv^2 a step: of the fall, and of the push at 2 m/s^2.
    falling, sliding = int(landing / h), 25
    assert lost.sum() == pytest.approx(h * h * (falling * G**2 + sliding * 2.0**2), rel=0.05)
    assert lost.sum() < 0.3 * fallen
    way = np.array(pushed.groups["states"].values["block.x"], dtype=float)
    work = (2 * G * 0.4 + 4.0) * (way[-1] - way[0])
    assert case.stepped[0].energies.actuators.sum() == pytest.approx(work)


def test_dissipation_falls_with_the_steps_and_warns_above_a_fifth() -> None:
    shares = []
    for count in (25, 50, 100):
        swing = arm(steps(count), np.array([0.9, 0.4, 0.0, -2.0]), 5 * np.sin(6 * steps(count)[1:]))
        check = row(certify(problem(ARM, 1.0), [swing], None), "dissipation")
        assert not check.judged
        assert check.passed == ((check.value or 0) <= 0.2)
        shares.append(check.value or 0)
    assert shares[0] > 0.2 > shares[2]
    assert 1.6 < shares[0] / shares[1] < 2.4
    assert 1.6 < shares[1] / shares[2] < 2.4


@pytest.mark.parametrize("name", ["forward dynamics", "replay of 0.15 s", "replay"])
def test_what_is_reported_falls_with_the_steps(name: str) -> None:
    values = []
    for count in (25, 50, 100):
        swing = arm(steps(count), np.array([0.9, 0.4, 0.0, -2.0]), 5 * np.sin(6 * steps(count)[1:]))
        check = row(certify(problem(ARM, 1.0), [swing], None), name)
        assert not check.judged
        values.append(check.value or np.inf)
    assert values[0] > 1.5 * values[1] > 2.25 * values[2]


def test_the_replay_of_another_motion_is_far_off() -> None:
    certificate = certify(problem({**BLOCK, "gravity": [0, -12]}, 1.0), [dropped()], None)
    assert (row(certificate, "replay of 0.15 s").value or 0) > 0.02
    assert (row(certify(problem(BLOCK, 1.0), [dropped()], None), "replay").value or 1) < 0.03


def test_a_replay_that_cannot_go_on_says_so() -> None:
    """Nothing is raised where a body has no inertia."""
    heavy = {**BLOCK, "bodies": {"block": {"mass": 2.0, "inertia": 0.0}}}
    certificate = certify(problem(heavy, 1.0), [dropped()], None)
    check = row(certificate, "replay")
    assert not check.judged
    assert "singular masses at t = 0 s" in str(check.where)


NAMES: dict[str, Any] = {
    "bounds": {"u": [-3, 12], "block.d(x)": [-5, 5]},
    "initial": {"block.x": 0, "block.d(x)": 1.0},
    "final": {"u": -3},
    "path": [
        {
            "name": "cone",
            "expression": "0.4*contact.foot.normal - abs(contact.foot.tangential)",
            "lower": 0,
        },
        {"name": "room", "expression": "contact.foot.gap", "lower": 0},
    ],
    "boundary": [{"name": "weight", "expression": "final.contact.foot.normal", "upper": 19.7}],
    "integrals": {"pressed": "contact.foot.normal", "moved": "energy.kinetic"},
    "objective": {"minimize": "pressed + 0*final.com.vy"},
}


def judged(**changes: Any) -> Certificate:
    told = dropped()
    total = float(np.sum(np.array(told.groups["forces"].values["contact.foot.normal"]))) / 40
    return certify(problem(BLOCK, 1.0, **{**NAMES, **changes}), [told], total, JUDGED)


def test_names_are_those_of_the_published_forces_at_the_ends_of_steps() -> None:
    certificate = judged()
    assert certificate.verdict == "certified", failures(certificate)
    assert row(certificate, "objective").value == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("changes", "check"),
    [
        ({"bounds": {"u": [-3, 11.9]}}, "control overshoot"),
        ({"bounds": {"block.d(x)": [-5, 1.5]}}, "state bounds"),
        ({"initial": {"block.d(x)": 1.01}}, "end values"),
        ({"final": {"u": -2.9}}, "end values"),
        ({"time": {"final": 1.1}}, "time"),
        (
            {"path": [{"name": "a", "expression": "contact.foot.normal", "upper": 19}]},
            "path constraints",
        ),
        (
            {"boundary": [{"name": "b", "expression": "final.contact.foot.normal", "upper": 19}]},
            "boundary constraints",
        ),
        ({"integrals": {"pressed": "1.01*contact.foot.normal"}}, "objective"),
    ],
)
def test_the_checks_of_other_phases_hold_for_these(changes: dict[str, Any], check: str) -> None:
    assert set(failures(judged(**changes))) == {check}
