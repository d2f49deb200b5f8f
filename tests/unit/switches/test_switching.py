"""Whole solves with switches: what is not smooth comes out exact, under every method."""

from typing import Any

import numpy as np
import pytest

import examples
from footfall.curves import Curves
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve

METHODS: list[dict[str, Any]] = [
    {"kind": "hermite_simpson", "segments": 20},
    {"kind": "hermite_simpson", "segments": 25, "control": "linear"},
    {"kind": "trapezoidal", "segments": 20},
    {"kind": "radau", "segments": 10, "points": 3},
    {"kind": "multiple_shooting", "segments": 20},
    {"kind": "chebyshev_lobatto", "segments": 4, "degree": 8},
]


def solved(document: dict[str, Any], **changes: Any) -> Solution:
    """Solve a changed example with switches."""
    return solve(read_problem(document | {"refinement": {"switches": True}} | changes))


@pytest.mark.parametrize("method", METHODS, ids=lambda m: f"{m['kind']}-{m['segments']}")
def test_minimum_time_is_exact(method: dict[str, Any]) -> None:
    solution = solved(examples.load("double_integrator"), method=method)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(2.0, abs=1e-6)
    assert solution.mesh_refinement.iterations[-1].switches == [pytest.approx(1.0, abs=1e-3)]


def test_the_result_is_the_users_phase() -> None:
    document = examples.load("double_integrator")
    solution = solved(document, method=METHODS[0])
    (phase,) = solution.phases
    assert phase.name == document["phases"][0]["name"]
    control = Curves.from_dict(phase.curves["controls"].model_dump())["u"]
    times = np.linspace(0, phase.knots[-1], 501)
    (switch,) = solution.mesh_refinement.iterations[-1].switches
    away = np.abs(times - switch) > 1e-6
    np.testing.assert_allclose(
        control(times[away]), np.where(times[away] < switch, 1.0, -1.0), atol=1e-4
    )
    assert phase.groups["controls"].time.count(switch) == 2


def test_bang_off_bang_with_absolute_values() -> None:
    """003, section 7.10: the least work of a strong block; (20 t)^2 with t^2 - t + 1/20 = 0."""
    document = examples.load("block_min_work_slack")
    switch = (1 - np.sqrt(1 - 4 / 20)) / 2
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx((20 * switch) ** 2, rel=1e-6)
    found = solution.mesh_refinement.iterations[-1].switches
    assert found == pytest.approx([switch, 1 - switch], abs=1e-5)


@pytest.mark.parametrize("name", ["block_min_fuel", "moon_landing", "singular_regulator"])
def test_examples_with_switches_meet_their_optimum(name: str) -> None:
    document = examples.load(name)
    known = next(row for row in document["known"] if row["quantity"] == "objective")
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(known["value"], rel=1e-6)
    assert solution.mesh_refinement.iterations[-1].switches


def test_a_smooth_problem_is_not_split() -> None:
    solution = solved(examples.load("pendulum_torque"))
    assert all(mesh.switches == [] for mesh in solution.mesh_refinement.iterations)
    assert solution.status is SolutionStatus.CONVERGED
