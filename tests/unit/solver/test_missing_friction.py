"""A task that friction alone could do: where there is none, the result says that it is missing."""

from typing import Any

import pytest

from schemas.errors import InvalidModel
from schemas.reading import read_problem
from schemas.results import Residual, Solution
from solver.pipeline import solve
from solver.solution.friction import friction_advice
from tests.support.robots import PENDULUM


def inching(friction: float = 0.0, **more: Any) -> dict[str, Any]:
    """A block moves by what is inside of it: a weight on a rail."""
    rest = {"block.x": 0, "block.angle": 0, "block.d(x)": 0, "d(rail)": 0, "rail": 0}
    body = {"mass": 1, "inertia": 0.1}
    rail = {"kind": "prismatic", "parent": "block", "child": "load", "axis": [1, 0]}
    phase = {
        "name": "inch",
        "system": {
            "kind": "mechanism",
            "bodies": {"block": body, "load": body},
            "joints": {
                "free": {"kind": "floating", "child": "block"},
                "rail": {**rail, "limits": [-0.3, 0.3]},
            },
            "contacts": {
                "left": {"body": "block", "at": [-0.5, -0.2]},
                "right": {"body": "block", "at": [0.5, -0.2]},
            },
            "surfaces": {"ground": {"friction": friction}},
            "motors": {"drive": {"joint": "rail", "torque": [-20, 20]}},
        },
        "time": {"final": 1},
        "initial": {**rest, "block.y": 0.2, "block.d(y)": 0, "block.d(angle)": 0},
        "final": {"block.x": 0.3, "rail": 0},
        "integrals": {"effort": "motor.drive.torque^2"},
    }
    return {
        "phases": [phase | more],
        "method": {"kind": "contact_implicit", "segments": 6},
        "objective": {"minimize": "effort"},
        "refinement": None,
    }


def solved(document: dict[str, Any]) -> Solution:
    return solve(read_problem(document))


def test_friction_that_is_missing_is_named() -> None:
    found = solved(inching())
    assert found.status == "locally_infeasible"
    assert {row.name for row in found.solver.residuals} <= {"path left cone", "path right cone"}
    missing = [line for line in found.advice if line.startswith("With more friction at")]
    assert missing
    assert "with 0," in missing[0]
    assert "N along the ground are missing at t = " in missing[0]


def test_what_no_friction_mends_is_blamed_itself() -> None:
    found = solved(inching(0.5, final={"block.x": 9}))
    assert found.status in {"locally_infeasible", "complementarity_stalled"}
    assert [row.name for row in found.solver.residuals] == ["bound block.x"]
    assert found.advice[0].startswith("Hardest to meet is 'bound block.x' in phase inch at t = 1 s")
    assert not [line for line in found.advice if "friction" in line]


def test_a_start_inside_of_the_ground_is_no_job_for_the_solver() -> None:
    document = inching(0.5)
    document["phases"][0]["initial"]["block.y"] = 0.1
    with pytest.raises(InvalidModel) as caught:
        solved(document)
    (issue,) = caught.value.issues
    assert issue.pointer == "/phases/0/initial"
    assert issue.message == "'left' starts 0.1 m inside of 'ground'"


def test_no_variable_of_our_own_is_told() -> None:
    for document in (inching(), inching(0.5)):
        found = solved(document)
        assert not [row.name for row in found.solver.residuals if "#" in row.name]
        assert "#" not in " ".join(found.advice)


def test_each_contact_is_told_once_and_only_those_that_there_are() -> None:
    names = ["path left cone", "path left cone", "path up cone", "path left gap", "bound block.x"]
    rows = [Residual(name=name, phase="inch", time=0.5, value=2.0) for name in names]
    (line,) = friction_advice(read_problem(inching(0.25)), rows)
    assert line == (
        "With more friction at 'left' the rest could be met: with 0.25, 2 N along the ground are "
        "missing at t = 0.5 s."
    )


def test_the_ground_of_a_robot_in_space_is_told_too() -> None:
    system = {
        "kind": "urdf",
        "text": PENDULUM,
        "contacts": {"tip": {"link": "bob"}},
        "ground": {"friction": 0},
    }
    document = {
        "phases": [{"name": "swing", "system": system, "time": {"final": 1}}],
        "method": {"kind": "contact_implicit"},
    }
    row = Residual(name="path tip cone", phase="swing", time=None, value=-3.0)
    (line,) = friction_advice(read_problem(document), [row])
    assert line.endswith("with 0, 3 N along the ground are missing.")
