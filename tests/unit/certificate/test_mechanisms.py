"""Mechanisms are judged by their bodies, read anew: errors of the solver's mechanics show."""

from typing import Any

import pytest

import solver.lowering.motion
from schemas.mechanisms import Mechanism
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Check, PhaseResult, Solution
from schemas.simulations import read_simulation
from solver import solve
from solver.certificate import certify
from solver.mechanics import Equations, equations_of
from solver.simulation import simulate

PENDULUM: dict[str, Any] = {
    "kind": "mechanism",
    "parameters": {"m": 1.2, "l": 0.7},
    "bodies": {
        "upper": {"mass": "m", "inertia": 0.02, "com": [0, "-l/2"]},
        "lower": {"mass": "m", "inertia": 0.02, "com": [0, "-l/2"]},
    },
    "joints": {
        "hip": {"kind": "revolute", "child": "upper"},
        "knee": {"kind": "revolute", "parent": "upper", "child": "lower", "at": [0, "-l"]},
    },
    "points": {"tip": {"body": "lower", "at": [0, "-l"]}},
    "motors": {"hip": {"joint": "hip"}, "knee": {"joint": "knee"}},
}


def swing(**changes: Any) -> Problem:
    phase = {
        "name": "swing",
        "system": PENDULUM,
        "time": {"final": 1},
        "initial": {"hip": 0, "knee": 0, "d(hip)": 0, "d(knee)": 0},
        "final": {"hip": 0.8, "knee": -0.4, "d(hip)": 0, "d(knee)": 0},
        "integrals": {"effort": "motor.hip.torque^2 + motor.knee.torque^2"},
        "path": [{"name": "room", "expression": "tip.x + 0.1*tip.vx", "upper": 5}],
        **changes,
    }
    return read_problem(
        {
            "phases": [phase],
            "objective": {"minimize": "effort"},
            "method": {"kind": "hermite_simpson", "segments": 12},
            "refinement": {"tolerance": 1e-5},
        }
    )


def rows(solution: Solution) -> dict[str, Check]:
    return {check.name: check for check in solution.certificate.checks}


def test_a_right_motion_is_certified() -> None:
    solution = solve(swing())
    assert solution.status == "converged"
    assert rows(solution)["interval defect"].value is not None


WRONG: dict[str, dict[str, Any]] = {
    "gravity upward": {"gravity": [0, 9.81]},
    "a motor the wrong way round": {
        "motors": {"hip": {"joint": "hip"}, "knee": {"joint": "knee", "gear": -1}}
    },
    "a centre of mass elsewhere": {
        "bodies": {
            **PENDULUM["bodies"],
            "lower": {"mass": "m", "inertia": 0.02, "com": [0, "-l/3"]},
        }
    },
    "an inertia about another point": {
        "bodies": {
            **PENDULUM["bodies"],
            "lower": {"mass": "m", "inertia": "0.02 + m*l^2/4", "com": [0, "-l/2"]},
        }
    },
}


@pytest.mark.parametrize("change", WRONG.values(), ids=WRONG.keys())
def test_wrong_mechanics_are_caught(
    monkeypatch: pytest.MonkeyPatch, change: dict[str, Any]
) -> None:
    _mislead(monkeypatch, change)
    solution = solve(swing())
    assert solution.status != "converged"
    assert not rows(solution)["interval defect"].passed


def test_wrong_names_are_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dynamics are right, but the tip of which the objective speaks is not where it is."""
    effort = "motor.hip.torque^2 + motor.knee.torque^2 + 10*tip.x"
    integrals = {"effort": effort}
    assert solve(swing(integrals=integrals)).status == "converged"
    _mislead(monkeypatch, {"points": {"tip": {"body": "lower", "at": [0, "-0.6*l"]}}})
    solution = solve(swing(integrals=integrals))
    assert solution.status == "certificate_failed"
    assert [name for name, one in rows(solution).items() if not one.passed] == ["objective"]


def _mislead(monkeypatch: pytest.MonkeyPatch, change: dict[str, Any]) -> None:
    """The solver gets the equations of another mechanism."""

    def altered(mechanism: Mechanism) -> Equations:
        document = {**mechanism.model_dump(mode="json"), **change}
        return equations_of(Mechanism.model_validate(document))

    monkeypatch.setattr(solver.lowering.motion, "equations_of", altered)


def test_what_a_mode_and_a_loop_hold_is_looked_at() -> None:
    stick = {
        "kind": "mechanism",
        "bodies": {"stick": {"mass": 1, "inertia": 0.1}, "arm": {"mass": 1, "inertia": 0.1}},
        "joints": {
            "free": {"kind": "floating", "child": "stick"},
            "loose": {"kind": "floating", "child": "arm"},
        },
        "contacts": {"foot": {"body": "stick", "at": [0, -0.5]}},
        "loops": {"pin": {"between": [{"body": "stick", "at": [0, 0.5]}, {"body": "arm"}]}},
        "mode": {"foot": "sticking"},
    }
    start = {"stick.y": 0.5, "arm.y": 1.0, "stick.d(x)": -0.5, "stick.d(angle)": 1}
    start["arm.d(x)"] = -1.0
    simulation = {"system": stick, "duration": 0.4, "initial": start}
    moved = simulate(read_simulation(simulation)).phases[0]
    problem = read_problem({"phases": [{"system": stick, "time": {"final": 0.4}}]})
    held = _check(problem, moved.model_copy(update={"name": "phase"}))
    assert held.passed
    assert held.value is not None
    assert held.value < 1e-8
    curves = moved.curves["states"]
    shifted = [[(row[0] or 0.0) + 0.01, *row[1:]] for row in curves.coefficients["stick.y"]]
    off = curves.model_copy(update={"coefficients": {**curves.coefficients, "stick.y": shifted}})
    curves_off = {**moved.curves, "states": off}
    failed = _check(problem, moved.model_copy(update={"name": "phase", "curves": curves_off}))
    assert not failed.passed
    assert failed.value == pytest.approx(0.01, rel=1e-6)


def _check(problem: Problem, result: PhaseResult) -> Check:
    certificate = certify(problem, [result], None)
    return next(check for check in certificate.checks if check.name == "contacts and loops")
