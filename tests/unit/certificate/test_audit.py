"""The audit passes steps that are right to round-off; one wrong law fails the checks it breaks."""

from typing import Any

import numpy as np
import pytest
import scipy.optimize

from schemas.results import Certificate, PhaseResult
from solver.certificate import JUDGED, certify
from tests.support.exact import failures
from tests.support.stepped import Array, problem, published, row
from tests.support.steps_by_hand import ARM, BLOCK, G, arm, block

KNOTS = np.linspace(0.0, 1.0, 41)
PUSH = np.where(KNOTS[1:] < 0.5, 12.0, -3.0)
SWING = np.linspace(0.0, 1.0, 26)
START = np.array([0.9, 0.4, 0.0, -6.0])
TORQUE = 5 * np.sin(6 * SWING[1:])


def judged(result: PhaseResult, **changes: Any) -> Certificate:
    return certify(problem(BLOCK, 1.0, **changes), [result], None, JUDGED)


def swung(result: PhaseResult, discretisation: str | None = None) -> Certificate:
    method = {"discretisation": discretisation} if discretisation else {}
    return certify(problem(ARM, 1.0, method=method), [result], None, JUDGED)


def changed(result: PhaseResult, group: str, name: str, step: int, by: float) -> PhaseResult:
    """One value of a published series, moved."""
    own = result.groups[group]
    values = list(own.values[name])
    values[step] = (values[step] or 0.0) + by
    other = own.model_copy(update={"values": {**own.values, name: values}})
    return result.model_copy(update={"groups": {**result.groups, group: other}})


def test_a_block_that_lands_slides_and_sticks_passes() -> None:
    """It lands at 0.24 s, slides under 12 N, and comes to rest under -3 N, which friction holds."""
    right = block(KNOTS, (0.0, 0.3, 1.0, 0.0), PUSH)
    certificate = judged(right)
    assert certificate.verdict == "certified"
    found = {check.name: check.value for check in certificate.checks if check.judged}
    assert max(value or 0.0 for value in found.values()) < 1e-13
    assert set(found) == {
        *("time", "step velocities", "normal work", "friction work", "energy balance"),
        *("momentum", "equations of motion", "complementarity"),
        *("penetration at knots", "penetration between knots", "slips between knots"),
    }


def test_links_with_a_stop_a_spring_and_a_damper_pass() -> None:
    right = arm(SWING, START, TORQUE)
    assert max(force or 0.0 for force in right.groups["forces"].values["limit.knee"]) > 4
    certificate = swung(right)
    assert certificate.verdict == "certified"
    for name in ("limit work", "energy balance", "equations of motion", "complementarity"):
        value = row(certificate, name).value
        assert value is not None
        assert value < 1e-12


def test_friction_that_pushes_along() -> None:
    """Momentum and energy are in order: friction is what it should not be."""
    wrong = block(KNOTS, (0.0, 0.0, 1.0, 0.0), PUSH, lambda stop, most: -np.sign(stop) * most)
    assert set(failures(judged(wrong))) == {"friction work", "complementarity"}


def test_sliding_inside_of_the_cone() -> None:
    wrong = block(
        KNOTS, (0.0, 0.0, 1.0, 0.0), PUSH, lambda stop, most: np.clip(stop, -most, most) / 2
    )
    assert set(failures(judged(wrong))) == {"complementarity"}


def test_more_friction_than_there_is() -> None:
    wrong = block(KNOTS, (0.0, 0.0, 1.0, 0.0), PUSH, lambda stop, most: stop)
    failed = failures(judged(wrong))
    assert set(failed) == {"complementarity"}
    assert "contact foot cone" in str(failed["complementarity"])


def test_ground_that_gives_way() -> None:
    """It comes to rest 1 mm deep: a law of contact is broken, and none of motion."""
    wrong = block(KNOTS, (0.0, 0.3, 1.0, 0.0), PUSH, floor=-1e-3)
    failed = failures(judged(wrong))
    assert set(failed) == {"complementarity", "penetration at knots"}
    assert row(judged(wrong), "penetration at knots").value == pytest.approx(1e-3)


def test_a_contact_that_pushes_off_from_afar() -> None:
    """2 N more than the weight, 0.3 m above the ground, and it rises."""
    lifted = [0.0, 0.3, 0.0, 0.0]
    h = float(KNOTS[1])
    rises = np.concatenate([[0.0], np.cumsum(h * h * np.arange(1, 41))])
    forces = {"normal": np.full(40, 2 * G + 2.0), "tangential": np.zeros(40)}
    states = {"block.x": np.zeros(41), "block.y": lifted[1] + rises, "block.angle": np.zeros(41)}
    starts = {f"block.d({word})": np.zeros(1) for word in ("x", "y", "angle")}
    wrong = published(
        KNOTS,
        {**states, **starts},
        {"u": np.zeros(40)},
        {f"contact.foot.{name}": one for name, one in forces.items()},
    )
    assert set(failures(judged(wrong))) == {"normal work", "complementarity"}


def test_an_impulse_that_did_not_act() -> None:
    """Of a step at rest on the ground: no work, so energy knows nothing of it."""
    right = block(KNOTS, (0.0, 0.0, 0.0, 0.0), 0 * PUSH)
    wrong = changed(right, "forces", "contact.foot.normal", 20, 1.0)
    failed = failures(judged(wrong))
    assert set(failed) == {"momentum", "equations of motion"}
    assert failed["momentum"] == "phase move, block.y, t = 0.525 s"


def test_an_impulse_that_is_missing_all_along() -> None:
    """Half of a thousandth in every step."""
    right = block(KNOTS, (0.0, 0.0, 0.0, 0.0), 0 * PUSH)
    values = right.groups["forces"].values
    light = {**values, "contact.foot.normal": [2 * G * 0.995] * 40}
    forces = right.groups["forces"].model_copy(update={"values": light})
    wrong = right.model_copy(update={"groups": {**right.groups, "forces": forces}})
    assert row(judged(wrong), "momentum").value == pytest.approx(0.005 / 1.995, rel=1e-3)


def test_a_torque_that_did_not_act_in_a_pose_that_rests() -> None:
    """Without motion there is no work: along the coordinates it shows all the same."""
    still = {"upper.angle": np.zeros(26), "lower.angle": np.full(26, 0.2)}
    starts = {"upper.d(angle)": np.zeros(1), "lower.d(angle)": np.zeros(1)}
    hung = published(
        SWING,
        {**still, **starts},
        {"motor.hip.torque": np.zeros(25)},
        {"limit.knee": np.zeros(25)},
    )
    failed = failures(swung(hung))
    assert set(failed) == {"equations of motion"}
    assert "lower.angle" in str(failed["equations of motion"])


def test_work_of_a_motor_that_is_not_in_the_books() -> None:
    wrong = changed(arm(SWING, START, TORQUE), "controls", "motor.hip.torque", 12, 1.0)
    assert set(failures(swung(wrong))) == {"energy balance", "equations of motion"}


def test_a_stop_that_pulls_and_one_that_pushes_too_early() -> None:
    right = arm(SWING, START, TORQUE)
    free = int(np.flatnonzero(np.array(right.groups["forces"].values["limit.knee"]) == 0.0)[-1])
    for push in (-1.0, 1.0):
        wrong = changed(right, "forces", "limit.knee", free, push)
        failed = failures(swung(wrong))
        assert {"complementarity", "energy balance", "equations of motion"} <= set(failed)
        side = "lower" if push > 0 else "upper"
        assert f"knee {side} limit" in str(failed["complementarity"])


def test_backward_euler_keeps_its_own_equations_and_loses_the_books() -> None:
    """The reason for the other steps: work that no force did."""
    euler = arm(SWING, START, TORQUE, euler=True)
    assert set(failures(swung(euler, "backward_euler"))) == {"energy balance"}
    assert set(failures(swung(euler))) == {"energy balance", "equations of motion"}


def test_velocities_that_are_not_those_of_the_steps() -> None:
    right = block(KNOTS, (0.0, 0.3, 1.0, 0.0), PUSH)
    wrong = changed(right, "states", "block.d(x)", 7, 1e-3)
    assert set(failures(judged(wrong))) == {"step velocities"}


def test_through_a_hump_between_two_knots() -> None:
    """No law is broken at any knot; in between, the block is 5 cm inside."""
    bumpy = {**BLOCK, "surfaces": {"ground": {"height": "0.06*exp(-(20*(x - 0.5))^2)"}}}
    knots = np.linspace(0.0, 1.0, 6)
    ones = np.ones(6)
    states = {"block.x": np.linspace(-0.5, 1.5, 6), "block.y": 0.01 * ones, "block.angle": 0 * ones}
    starts = {
        "block.d(x)": np.array([2.0]),
        "block.d(y)": np.zeros(1),
        "block.d(angle)": np.zeros(1),
    }
    forces = {f"contact.foot.{name}": np.zeros(5) for name in ("normal", "tangential")}
    flown = published(knots, {**states, **starts}, {"u": np.zeros(5)}, forces)
    certificate = certify(problem({**bumpy, "gravity": [0, 0]}, 1.0), [flown], None)
    assert set(failures(certificate)) == {"penetration between knots"}
    assert (row(certificate, "penetration between knots").value or 0) > 0.02


def test_a_number_that_is_missing_fails() -> None:
    right = block(KNOTS, (0.0, 0.3, 1.0, 0.0), PUSH)
    gone = changed(right, "states", "block.y", 3, np.nan)
    assert {"momentum", "complementarity", "energy balance"} <= set(failures(judged(gone)))


def test_a_series_that_is_missing_is_told() -> None:
    right = block(KNOTS, (0.0, 0.3, 1.0, 0.0), PUSH)
    bare = {name: one for name, one in right.groups.items() if name != "forces"}
    told = failures(judged(right.model_copy(update={"groups": bare})))
    assert told == {"curves": "phase move has no 40 values of contact.foot.normal"}


@pytest.mark.parametrize("friction", ["sliding", "no_slip"])
def test_what_presses_does_not_slip_where_that_is_the_law(friction: str) -> None:
    sliding: Array = np.where(KNOTS[1:] < 0.5, 12.0, -3.0)
    slid = judged(block(KNOTS, (0.0, 0.0, 1.0, 0.0), sliding), method={"friction": friction})
    held = judged(block(KNOTS, (0.0, 0.0, 0.0, 0.0), 0 * sliding), method={"friction": friction})
    assert row(held, "complementarity").passed
    assert row(slid, "complementarity").passed == (friction == "sliding")


DRUM: dict[str, Any] = {
    "kind": "mechanism",
    "bodies": {"bead": {"mass": 1.5, "inertia": 0.1}, "drum": {"mass": 1, "inertia": 1}},
    "joints": {
        "free": {"kind": "floating", "child": "bead"},
        "axle": {"kind": "revolute", "child": "drum"},
    },
    "contacts": {"spot": {"body": "bead"}},
    "shapes": {"round": {"body": "drum", "circle": 0.5}},
    "pairs": {"spot": {"contact": "spot", "against": "round", "friction": 0}},
}


def bead(knots: Array) -> PhaseResult:
    """It slides down a drum, from 0.5 rad off its top, without friction: the gap's exact change."""
    turns, before, normal = [np.pi / 2 - 0.5], 0.4 * np.exp(-0.5j), []
    for h in np.diff(knots):
        z0 = 0.5 * np.exp(1j * turns[-1])

        def left(x: Array, z0: complex = z0, h: float = h, before: complex = before) -> list[float]:
            z1 = 0.5 * np.exp(1j * x[0])
            off = 1.5 * ((z1 - z0) / h - before + 1j * G * h) - h * x[1] * (z0 + z1)
            return [off.real, off.imag]

        turn, push = scipy.optimize.fsolve(left, [turns[-1] - 0.8 * h, 10.0], xtol=1e-13)
        before = (0.5 * np.exp(1j * turn) - z0) / h
        turns.append(turn)
        normal.append(push)
    z, still = 0.5 * np.exp(1j * np.array(turns)), np.zeros(len(turns))
    states = {"bead.x": z.real, "bead.y": z.imag, "bead.angle": still, "axle": still}
    start = 0.4 * np.exp(-0.5j)
    starts = {"bead.d(x)": start.real, "bead.d(y)": start.imag, "bead.d(angle)": 0, "d(axle)": 0}
    told = {name: np.array([one]) for name, one in starts.items()}
    forces = {"normal": np.array(normal), "tangential": still[1:]}
    named = {f"contact.spot.{name}": one for name, one in forces.items()}
    return published(knots, {**states, **told}, {}, named)


@pytest.mark.parametrize("count", [5, 20])
def test_a_bead_that_slides_down_a_drum_passes_but_not_under_another_force(count: int) -> None:
    """On what is curved averages differ; there is room for that, and not for 3 percent of force."""
    right = bead(np.linspace(0.0, 0.2, count + 1))
    certificate = certify(problem(DRUM, 0.2), [right], None, JUDGED)
    assert certificate.verdict == "certified"
    assert (row(certificate, "energy balance").value or 0) < 1e-12
    force = right.groups["forces"].values["contact.spot.normal"][2] or 0.0
    wrong = changed(right, "forces", "contact.spot.normal", 2, 0.03 * force)
    failed = failures(certify(problem(DRUM, 0.2), [wrong], None, JUDGED))
    assert set(failed) == {"momentum", "equations of motion"}
