"""A phase of curves before one of steps: each is judged by its own checks, ends by the same."""

from typing import Any

import numpy as np

from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, PhaseResult
from solver.certificate import JUDGED, certify
from tests.support.exact import failures, result
from tests.support.steps_by_hand import BLOCK, G, block

STEPS = np.linspace(0.2, 0.7, 26)
NAMES = {"x": "x", "y": "y", "along": "d(x)", "down": "d(y)"}


def flown(fall: float = G) -> PhaseResult:
    """0.2 s of free flight from 0.6 m, at 1 m/s along the ground."""
    states = {
        "block.x": lambda t: t,
        "block.y": lambda t: 0.6 - fall * t**2 / 2,
        "block.angle": lambda t: 0 * t,
        "block.d(x)": lambda t: 0 * t + 1,
        "block.d(y)": lambda t: -fall * t,
        "block.d(angle)": lambda t: 0 * t,
    }
    breaks = np.linspace(0.0, 0.2, 3)
    return result(states, {"u": lambda t: 0 * t}, breaks, name="fly")


def landed(height: float = 0.6 - G * 0.02) -> PhaseResult:
    """Half a second of steps from there: it lands at once and slides."""
    found = block(STEPS, (0.2, height, 1.0, -0.2 * G), np.zeros(25))
    return found.model_copy(update={"name": "land"})


def posed() -> Problem:
    rows: list[dict[str, Any]] = [
        {
            "name": name,
            "expression": f"land.initial.block.{own} - fly.final.block.{own}",
            "lower": 0,
            "upper": 0,
        }
        for name, own in NAMES.items()
    ]
    fly = {
        "name": "fly",
        "system": BLOCK,
        "time": {"final": 0.2},
        "method": {"kind": "hermite_simpson"},
    }
    land = {
        "name": "land",
        "system": BLOCK,
        "time": {"duration": 0.5},
        "integrals": {"pressed": "contact.foot.normal"},
    }
    return read_problem(
        {
            "phases": [fly, land],
            "linkages": rows,
            "objective": {"minimize": "land.pressed"},
            "method": {"kind": "contact_implicit"},
        }
    )


def judged(*phases: PhaseResult) -> Certificate:
    pressed = phases[1].groups["forces"].values["contact.foot.normal"]
    total = 0.02 * sum(one or 0.0 for one in pressed)
    return certify(posed(), phases, total, JUDGED)


def test_both_pass_by_their_own_checks() -> None:
    certificate = judged(flown(), landed())
    assert certificate.verdict == "certified"
    names = [check.name for check in certificate.checks]
    assert {"interval defect", "continuity", "linkages", "objective", "energy balance"} < set(names)


def test_a_flight_that_falls_too_fast_is_no_matter_of_the_audit() -> None:
    failed = failures(judged(flown(G + 0.5), landed()))
    assert set(failed) == {"interval defect", "linkages"}
    assert "phase fly" in str(failed["interval defect"])


def test_steps_that_begin_elsewhere() -> None:
    failed = failures(judged(flown(), landed(0.5)))
    assert failed == {"linkages": "linkage y"}
