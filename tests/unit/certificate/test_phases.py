"""Several phases, statics, and what holds over all of them."""

import math
from typing import Any

import numpy as np
import pytest

from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Certificate, PhaseResult
from solver.certificate import certify
from tests.support.exact import block_problem, block_result, failures, result

# A unit mass speeds up at 2 m/s2 for 1 s, then a closed form takes over: it rolls for 0.5 s.
RUN: dict[str, Any] = {
    "name": "run",
    "system": {
        "kind": "ode",
        "states": ["x", "v"],
        "controls": ["u"],
        "derivatives": {"x": "v", "v": "u"},
    },
    "time": {"final": [0.5, 2]},
    "initial": {"x": 0, "v": 0},
    "integrals": {"effort": "u^2"},
}
ROLL: dict[str, Any] = {
    "name": "roll",
    "system": {
        "kind": "closed_form",
        "states": {"z": "initial.z + initial.w*(t - initial.t)", "w": "initial.w"},
    },
    "time": {"duration": [0.1, 1]},
    "final": {"z": 2},
    "integrals": {"way": "w"},
}
LINKAGES: list[dict[str, Any]] = [
    {"name": "place", "expression": "run.final.x - roll.initial.z", "lower": 0, "upper": 0},
    {"name": "speed", "expression": "run.final.v - roll.initial.w", "lower": 0, "upper": 0},
]
OBJECTIVE = {"minimize": "run.effort + roll.duration + roll.way - run.final.x"}


def problem(run: dict[str, Any] = {}, roll: dict[str, Any] = {}, **top: Any) -> Problem:  # noqa: B006
    document = {"linkages": LINKAGES, "objective": OBJECTIVE, **top}
    return read_problem({"phases": [{**RUN, **run}, {**ROLL, **roll}], **document})


def motion(place: float = 1.0, start: float = 1.0) -> list[PhaseResult]:
    """The second phase from ``place``, at ``start``."""
    run = {"x": lambda t: t**2, "v": lambda t: 2 * t}
    roll = {"z": lambda t: place + 2 * (t - start), "w": lambda t: 2 + 0 * t}
    return [
        result(run, {"u": lambda t: 2 + 0 * t}, np.linspace(0, 1, 4), 2, "run"),
        result(roll, {}, np.array([start, start + 0.5]), 1, "roll"),
    ]


VALUE = 4 + 0.5 + 1 - 1


def test_two_phases_of_different_kinds_are_certified() -> None:
    certificate = certify(problem(), motion(), VALUE)
    assert certificate.verdict == "certified"
    assert "linkages" in [check.name for check in certificate.checks]


def test_the_order_of_the_results_does_not_matter() -> None:
    assert certify(problem(), motion()[::-1], VALUE).verdict == "certified"


def test_a_linkage_that_is_not_kept() -> None:
    certificate = certify(problem(roll={"final": {}}), motion(place=1.01), VALUE)
    assert failures(certificate) == {"linkages": "linkage place"}
    links = next(check for check in certificate.checks if check.name == "linkages")
    assert links.value == pytest.approx(0.01)


def test_a_linkage_without_a_value() -> None:
    rows = [{"name": "none", "expression": "sqrt(-run.final.x)", "lower": 0}]
    certificate = certify(problem(linkages=rows), motion(), VALUE)
    assert failures(certificate) == {"linkages": "linkage none"}


def test_a_phase_that_starts_at_another_time() -> None:
    failed = failures(certify(problem(), motion(start=1.01), VALUE))
    assert failed == {"time": "phase roll, initial.t is not phase run, final.t"}


def test_a_phase_that_takes_too_long() -> None:
    changed = problem(roll={"time": {"duration": 0.4}})
    assert failures(certify(changed, motion(), VALUE)) == {"time": "phase roll, duration"}
    changed = problem(roll={"time": {"final": 1.4}})
    assert failures(certify(changed, motion(), VALUE)) == {"time": "phase roll, final.t"}


def test_every_phase_is_judged() -> None:
    changed = problem(roll={"bounds": {"w": [None, 1.5]}})
    assert failures(certify(changed, motion(), VALUE)) == {"state bounds": "phase roll, w, t = 1 s"}
    missing = failures(certify(problem(), motion()[:1], VALUE))
    assert missing == {"curves": "phase roll has no result"}


def test_the_objective_is_that_of_all_phases() -> None:
    assert list(failures(certify(problem(), motion(), VALUE + 1e-3))) == ["objective"]


HEAVY: dict[str, Any] = {
    "system": {
        "kind": "ode",
        "states": ["x", "v"],
        "controls": ["u"],
        "define": {"a": "u/m"},
        "derivatives": {"x": "v", "v": "a"},
    },
    "path": [{"name": "push", "expression": "m*a", "lower": -6, "upper": 6}],
    "boundary": [{"name": "weight", "expression": "final.x/m", "lower": 1, "upper": 1}],
    "integrals": {"effort": "m*u^2"},
    "objective": {"minimize": "effort + m"},
}
"""The block, its mass free; it is one."""


def heavy(bounds: Any = (0.5, 3), **changes: Any) -> Problem:
    return block_problem(**{**HEAVY, **changes}, static={"m": {"bounds": list(bounds)}})


def judged(mass: float | None, value: float = 13.0, **changes: Any) -> Certificate:
    return certify(heavy(**changes), [block_result()], value, statics={"m": mass})


def test_statics_are_seen_everywhere() -> None:
    certificate = judged(1.0)
    assert certificate.verdict == "certified"
    assert "static bounds" in [check.name for check in certificate.checks]


def test_another_static_is_another_motion() -> None:
    assert set(failures(judged(1.1))) == {"interval defect", "boundary constraints", "objective"}


def test_a_static_out_of_bounds() -> None:
    assert failures(judged(1.0, bounds=(1.5, 3))) == {"static bounds": "static m"}


@pytest.mark.parametrize("value", [None, math.nan])
def test_a_static_without_a_value_fails_whatever_its_bounds(value: float | None) -> None:
    failed = failures(judged(value, bounds=(None, None), boundary=[], path=[]))
    assert failed["static bounds"] == "static m"
    assert "interval defect" in failed


def test_statics_stand_in_linkages() -> None:
    rows = [{"name": "size", "expression": "run.final.x - length", "lower": 0, "upper": 0}]
    changed = problem(linkages=rows, static={"length": {"bounds": [0, 9]}})
    assert certify(changed, motion(), VALUE, statics={"length": 1.0}).verdict == "certified"
    failed = failures(certify(changed, motion(), VALUE, statics={"length": 1.1}))
    assert failed == {"linkages": "linkage size"}


def test_an_integral_that_nothing_depends_on_is_not_judged() -> None:
    wild = block_problem(integrals={"effort": "u^2", "wild": "sqrt(0.5 - x)"})
    assert certify(wild, [block_result()], 12.0).verdict == "certified"


@pytest.mark.parametrize("wild", ["sqrt(0.5 - x)", "1/(x - 0.3)^2"])
def test_an_integral_that_a_constraint_depends_on_is_judged(wild: str) -> None:
    row = {"name": "tame", "expression": "wild"}
    integrals = {"effort": "u^2", "wild": wild}
    changed = block_problem(integrals=integrals, boundary=[row | {"lower": 0}])
    assert list(failures(certify(changed, [block_result()], 12.0))) == ["boundary constraints"]
    changed = block_problem(integrals=integrals, linkages=[row | {"lower": 0}])
    assert list(failures(certify(changed, [block_result()], 12.0))) == ["linkages"]
