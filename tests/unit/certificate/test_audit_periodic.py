"""Where a phase is periodic, its last step comes before the first, by the same exact chords."""

from typing import Any

import numpy as np
import pytest

from schemas.results import PhaseResult
from solver.certificate import JUDGED, certify
from tests.support.exact import failures
from tests.support.stepped import Array, problem, published

MASS, LONG, INERTIA, G = 1.2, 0.7, 0.03, 9.81
KNOTS = np.linspace(0.0, 1.0, 13)
PAIR: dict[str, Any] = {
    "kind": "mechanism",
    "angles": "absolute",
    "bodies": {
        side: {"mass": MASS, "inertia": INERTIA, "com": [0, -LONG]} for side in ("left", "right")
    },
    "joints": {f"{side}_hip": {"kind": "revolute", "child": side} for side in ("left", "right")},
    "motors": {side: {"joint": f"{side}_hip"} for side in ("left", "right")},
}
"""Two links that swing by themselves."""


def swung(before: int) -> PhaseResult:
    """The right link half a period after the left one; ``before``: the steps are made from there.

    The torques follow from the motion: those of exact changes along the chords.
    """
    h = KNOTS[1]
    torques, states, starts = {}, {}, {}
    for side, phase in (("left", 0.3), ("right", 0.3 + np.pi)):
        turns = 0.6 * np.sin(np.pi * np.arange(-1, len(KNOTS)) * h + phase)
        chords = np.diff(LONG * np.exp(1j * turns)) / h / 1j
        if not before:  # as if it started at its first knot with its velocity there
            chords[0] = LONG * np.exp(1j * turns[1]) * (turns[1] - turns[0]) / h
        slopes = np.diff(LONG * np.exp(1j * turns)) / np.diff(turns) / 1j
        moved = MASS * (slopes[1:].conj() * (np.diff(chords) + 1j * G * h)).real
        torques[f"motor.{side}.torque"] = (moved + INERTIA * np.diff(turns, 2) / h) / h
        states[f"{side}.angle"] = turns[1:]
        starts[f"{side}.d(angle)"] = np.diff(turns)[:1] / h
    return published(KNOTS, {**states, **starts}, torques, {})


@pytest.mark.parametrize("periodic", [None, {"swap": [["left", "right"]]}, {}])
@pytest.mark.parametrize("before", [0, 1])
def test_what_comes_before_the_first_step(periodic: dict[str, Any] | None, before: int) -> None:
    posed = problem(PAIR, 1.0, **({} if periodic is None else {"periodic": periodic}))
    certificate = certify(posed, [swung(before)], None, JUDGED)
    if bool(periodic) if before else periodic is None:
        assert certificate.verdict == "certified"
        return
    failed = failures(certificate)
    assert set(failed) == {"energy balance", "equations of motion"}
    assert "t = 0.0833" in str(failed["energy balance"])


def test_the_parts_of_a_period_are_those_of_the_swap() -> None:
    """The motion is the one that the test means: each link goes on as the other began."""
    angles: dict[str, Array] = {
        side: np.array(swung(1).groups["states"].values[f"{side}.angle"], dtype=float)
        for side in ("left", "right")
    }
    assert angles["left"][-1] == pytest.approx(angles["right"][0])
    assert angles["right"][-1] == pytest.approx(angles["left"][0])
