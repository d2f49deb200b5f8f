"""Limits of joints and motors: bounds of their phases, and rows where they are no variables."""

from typing import Any

import pytest

from schemas import resolve
from schemas.errors import BadProblem
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.mechanics import limited
from solver.model import build_model
from solver.pipeline import solve


def problem(system: dict[str, Any] | None = None, **phase: Any) -> Problem:
    """An arm with a motor that turns by one radian in a second, at least effort."""
    arm = {
        "kind": "mechanism",
        "parameters": {"most": 2.0},
        "gravity": [0, 0],
        "bodies": {"arm": {"mass": 1, "inertia": 0.5}},
        "joints": {"hinge": {"kind": "revolute", "child": "arm", "limits": ["-most", "most"]}},
        "motors": {"hinge": {"joint": "hinge"}},
        **(system or {}),
    }
    only = {
        "system": arm,
        "time": {"final": 1},
        "initial": {name: 0 for name in ("hinge", "d(hinge)") if not phase.get("initial")},
        "integrals": {"effort": "motor.hinge.torque^2"},
        **phase,
    }
    return read_problem({"phases": [only], "objective": {"minimize": "effort"}})


def bound(given: Problem, name: str) -> tuple[float, float]:
    return resolve.interval(limited(given).phases[0].bounds[name], {})


def motor(**limits: Any) -> dict[str, Any]:
    return {"motors": {"hinge": {"joint": "hinge", **limits}}}


def test_limits_become_bounds_and_the_tighter_ones_hold() -> None:
    assert bound(problem(), "hinge") == (-2, 2)
    assert bound(problem(bounds={"hinge": [-1, 5]}), "hinge") == (-1, 2)
    assert bound(problem(motor(torque=[-3, 4])), "motor.hinge.torque") == (-3, 4)


def test_a_gear_divides_the_limits_of_the_torque() -> None:
    assert bound(problem(motor(torque=[-3, 6], gear=3)), "motor.hinge.torque") == (-1, 2)
    assert bound(problem(motor(torque=[-3, 6], gear=-3)), "motor.hinge.torque") == (-2, 1)


def test_rows_are_called_what_users_call_them() -> None:
    given = problem(motor(speed=[-5, 5], power=[None, 10]))
    labels = [row.label for row in build_model(limited(given)).phases[0].path]
    assert labels == ["bound motor.hinge.speed", "bound motor.hinge.power"]
    absolute = limited(problem({"angles": "absolute"}, initial={"arm.angle": 0}))
    assert [row.label for row in build_model(absolute).phases[0].path] == ["bound hinge"]


def test_a_gear_that_the_solver_chooses_makes_a_row() -> None:
    given = problem(motor(torque=[-3, 6], gear=2)).model_dump(mode="json")
    given["phases"][0]["system"]["motors"]["hinge"]["gear"] = "ratio"
    given["static"] = {"ratio": {"bounds": [1, 10]}}
    (row,) = limited(read_problem(given)).phases[0].path
    assert row.name == "motor hinge torque"
    assert resolve.interval(row, {}) == (-3, 6)


def test_what_is_no_mechanism_stays_itself() -> None:
    given = read_problem(
        {
            "phases": [
                {
                    "system": {"kind": "ode", "states": ["x"], "derivatives": {"x": "1"}},
                    "time": {"final": 1},
                }
            ]
        }
    )
    assert limited(given) is given


def solved(kind: str, **limits: Any) -> Any:
    """A turn by one radian from rest to rest, on one mesh."""
    given = problem(motor(**limits), final={"hinge": 1, "d(hinge)": 0}).model_dump(mode="json")
    given |= {"method": {"kind": kind, "segments": 12}, "refinement": None}
    return solve(read_problem(given))


@pytest.mark.parametrize("kind", ["hermite_simpson", "radau", "multiple_shooting", "dircol5i"])
def test_every_method_turns_the_arm_within_its_limits(kind: str) -> None:
    """The least effort is 12 I^2 d^2 / T^3, its torque a straight line."""
    found = solved(kind, torque=[-3.1, 3.1], power=[None, 10])
    assert found.status == "converged"
    assert found.certificate.verdict == "certified"
    assert found.objective == pytest.approx(3, rel=1e-6)


def test_a_limit_on_power_costs_effort() -> None:
    """Without one it is I (6 - 12 t) (6 t - 6 t^2), which reaches 3^(1/2) W."""
    found = solved("radau", power=[None, 1.2])
    controls, states = (found.phases[0].groups[name].values for name in ("controls", "states"))
    assert found.objective > 3.01
    assert controls.keys() == {"motor.hinge.torque"}
    assert states.keys() == {"hinge", "d(hinge)"}
    assert found.certificate.checks
    assert max(row.value for row in found.certificate.checks if row.name == "state bounds") < 0.02


def test_bounds_and_limits_that_exclude_each_other_are_refused() -> None:
    with pytest.raises(BadProblem) as refused:
        problem(bounds={"hinge": [3, 4]})
    told = {issue.pointer: issue.message for issue in refused.value.issues}
    assert "limits" in told["/phases/0/bounds/hinge"]
