"""Modes of a given sequence: sliding, falling, landing; what is between them."""

from typing import Any

import numpy as np
import pytest

from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve
from solver.hybrid import expand
from tests.unit.hybrid.documents import flat_foot, slider

UPRIGHT: dict[str, Any] = {"block.angle": 0, "push": 0, "lift": 0}
REST = {"name": "rest", "contacts": {"foot": "sticking"}, "duration": [0.05, 1]}
FALL = {"name": "fall", "duration": [0.05, 1]}


def solved(document: dict[str, Any]) -> Solution:
    solution = solve(read_problem(document))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    return solution


def series(solution: Solution, phase: int, name: str) -> list[float]:
    return [
        value for value in solution.phases[phase].groups["states"].values[name] if value is not None
    ]


def test_a_block_slides_until_friction_stops_it() -> None:
    """At mu g; a torque against the moment of friction keeps it upright."""
    solution = solved(
        slider(
            [{"name": "slide", "contacts": {"foot": "sliding_right"}}],
            bounds=UPRIGHT,
            initial={"block.x": 0, "block.d(x)": 2},
            final={"block.d(x)": 0},
            time={"final": [0.1, 2]},
        )
    )
    duration, distance = 2 / (0.5 * 9.81), 4 / (2 * 0.5 * 9.81)
    assert solution.phases[0].knots[-1] == pytest.approx(duration, rel=1e-7)
    assert series(solution, 0, "block.x")[-1] == pytest.approx(distance, rel=1e-7)
    assert solution.objective == pytest.approx((0.1 * 0.5 * 2 * 9.81) ** 2 * duration, rel=1e-7)


def test_a_block_falls_and_lands() -> None:
    """The impulse is what its fall has gathered; there is no bounce."""
    solution = solved(
        slider(
            [FALL, REST],
            bounds=UPRIGHT,
            initial={"block.x": 0, "block.y": 0.6, "block.d(x)": 0, "block.d(y)": 0},
            time={"final": 1.0},
        )
    )
    assert [phase.name for phase in solution.phases] == ["move/fall", "move/rest"]
    assert solution.phases[0].knots[-1] == pytest.approx(np.sqrt(2 * 0.5 / 9.81), rel=1e-8)
    impulse = solution.static["move/fall.impact.foot.normal"]
    assert impulse == pytest.approx(2 * np.sqrt(2 * 9.81 * 0.5), rel=1e-8)
    assert solution.static["move/fall.impact.foot.tangential"] == pytest.approx(0, abs=1e-7)
    assert np.abs(series(solution, 1, "block.d(y)")).max() < 1e-10
    assert solution.mode_sequence is not None
    assert [mode.contacts for mode in solution.mode_sequence.modes] == [{}, {"foot": "sticking"}]
    assert (solution.mode_sequence.distinct, solution.mode_sequence.possible) == (2, 2)


def test_a_block_that_lands_sliding_is_slowed_by_friction() -> None:
    """The tangential impulse is mu times the normal one, and the block slides on.

    Its contact is at its centre, so that friction does not turn it.
    """
    slide = {"name": "slide", "contacts": {"foot": "sliding_right"}, "duration": 0.1}
    document = slider(
        [FALL, slide],
        bounds=UPRIGHT,
        initial={"block.x": 0, "block.y": 0.2, "block.d(x)": 3, "block.d(y)": 0},
        time={"final": [0.1, 1.0]},
    )
    document["phases"][0]["system"]["contacts"] = {"foot": {"body": "block"}}
    solution = solved(document)
    landed = 3 - 0.5 * np.sqrt(2 * 9.81 * 0.2)
    speed = series(solution, 1, "block.d(x)")
    assert speed[0] == pytest.approx(landed, rel=1e-8)
    assert speed[-1] == pytest.approx(landed - 0.5 * 9.81 * 0.1, rel=1e-8)


def test_a_foot_sticks_within_its_cone() -> None:
    """A push may not be harder than friction and what lifts the block allow."""
    document = slider(
        [{"name": "stand", "contacts": {"foot": "sticking"}}],
        bounds={"block.angle": 0},
        initial={"block.x": 0, "block.d(x)": 0},
    )
    document["phases"][0] |= {"integrals": {"effort": "(push - 12)^2 + lift^2 + turn^2"}}
    solution = solved(document)
    forces, controls = (solution.phases[0].groups[name].values for name in ("forces", "controls"))
    normal, tangential = (
        np.array(forces[f"contact.foot.{way}"]) for way in ("normal", "tangential")
    )
    assert np.all(np.abs(tangential) <= 0.5 * normal + 1e-6)
    assert np.allclose(np.array(controls["push"]), -tangential, atol=1e-6)
    assert np.allclose(np.abs(tangential), 0.5 * normal, atol=1e-4)


def test_toe_and_heel_land_at_once() -> None:
    """Two tangential impulses for one row: one of them is drawn to nothing."""
    document = flat_foot({})
    document["phases"][0] |= {
        "initial": {"foot.x": 0, "foot.y": 0.05, "foot.angle": 0, "ankle": 0, "d(ankle)": 0}
        | {f"foot.d({one})": 0 for one in ("x", "y", "angle")},
        "final": {},
        "time": {"final": 0.3},
    }
    document["method"]["sequence"] = [
        {"name": "fall", "duration": [0.05, 0.25]},
        {"name": "stand", "contacts": {"toe": "sticking", "heel": "sticking"}},
    ]
    solution = solved(document)
    assert solution.solver.iterations < 40
    both = [solution.static[f"lean/fall.impact.{one}.normal"] for one in ("toe", "heel")]
    assert sum(one for one in both if one is not None) == pytest.approx(
        6 * np.sqrt(2 * 9.81 * 0.05)
    )


def expanded(document: dict[str, Any]) -> Problem:
    return expand(read_problem(document)).problem


def test_what_the_user_says_of_a_phase_is_said_of_its_modes() -> None:
    document = slider(
        [FALL, REST],
        initial={"block.y": 0.6},
        final={"block.x": 1},
        boundary=[{"name": "far", "expression": "final.block.x - initial.block.x", "lower": 1}],
        time={"final": 1.0, "duration": [0.5, 2]},
    )
    problem = expanded(document)
    first, last = problem.phases
    assert list(first.initial) == ["block.y"]
    assert list(last.final) == ["block.x"]
    assert (first.final, last.initial) == ({}, {})
    assert first.time.final is None
    texts = {row.name: row.expression.tree for row in problem.linkages}
    assert "far" in texts
    assert "duration" in texts
    assert problem.objective is not None
    names = {row.name for row in last.path}
    assert {"foot presses", "foot sticks left", "foot sticks right"} <= names
    assert [row.name for row in first.path] == ["foot stays open"]


def test_velocities_go_on_where_nothing_lands() -> None:
    problem = expanded(slider([REST, FALL]))
    assert "block.d(y) goes on" in {row.name for row in problem.linkages}
    assert not problem.static


def test_segments_are_shared_by_duration() -> None:
    problem = expanded(slider([FALL | {"duration": 0.75}, REST | {"duration": 0.25}]))
    methods = [phase.method for phase in problem.phases]
    assert [method.segments for method in methods if method is not None] == [9, 3]


def test_a_problem_without_schedules_stays_as_it_is() -> None:
    document = slider([REST]) | {"method": {"kind": "hermite_simpson"}}
    problem = read_problem(document)
    assert expand(problem).problem is problem


def test_a_result_is_a_guess() -> None:
    """Its modes are matched by name, its impulses too, its forces are known."""
    document = slider(
        [FALL, REST],
        bounds=UPRIGHT,
        initial={"block.x": 0, "block.y": 0.6, "block.d(x)": 0, "block.d(y)": 0},
        time={"final": 1.0},
    )
    first = solved(document)
    phases = [{"name": one.name, "curves": one.model_dump()["curves"]} for one in first.phases]
    guess = {"kind": "solution", "phases": phases, "static": first.static}
    again = solved(document | {"guess": guess})
    assert again.solver.iterations < first.solver.iterations
    assert again.objective == pytest.approx(first.objective, abs=1e-8)


def test_stages_go_on_from_mode_to_mode() -> None:
    document = slider(
        [FALL, REST],
        bounds={"block.angle": 0},
        initial={"block.x": 0, "block.y": 0.6, "block.d(x)": 0, "block.d(y)": 0},
        time={"final": 1.0},
    )
    document["phases"][0]["system"]["contacts"] = {"foot": {"body": "block"}}
    document["stages"] = [
        {},
        {"phases": {"move": {"final": {"block.x": 0.1}, "initial": {"block.y": 0.5}}}},
    ]
    solution = solved(document)
    assert len(solution.stages) == 2
    assert [phase.name for phase in solution.phases] == ["move/fall", "move/rest"]
