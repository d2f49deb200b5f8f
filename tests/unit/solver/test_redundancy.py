"""Equalities that follow from others are dropped and reported; contradictions are told apart."""

from typing import Any

import pytest

from schemas.results import SolutionStatus
from tests.unit.solver.problems import block, solved


def with_boundary(expression: str, value: float) -> dict[str, Any]:
    row = {"name": "span", "expression": expression, "lower": value, "upper": value}
    return block(phase={"boundary": [row]})


def test_a_value_that_others_imply_is_dropped() -> None:
    solution = solved(with_boundary("final.x - initial.x", 1))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(12)
    assert [line for line in solution.warnings if "dropped" in line]


def test_a_row_over_fixed_values_only_is_dropped() -> None:
    solution = solved(with_boundary("initial.v^2", 0))
    assert solution.status is SolutionStatus.CONVERGED
    assert "'boundary span' follows from the other equalities and was dropped." in solution.warnings


def test_a_constant_state_fixed_at_both_ends() -> None:
    document = block(
        system={
            "states": ["x", "v", "c"],
            "derivatives": {"x": "v", "v": "u", "c": "0"},
        },
        phase={"initial": {"x": 0, "v": 0, "c": 3}, "final": {"x": 1, "v": 0, "c": 3}},
    )
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED
    assert "'final c' follows from the other equalities and was dropped." in solution.warnings


def test_a_contradiction_is_kept_and_named() -> None:
    solution = solved(with_boundary("final.x - initial.x", 2))
    assert solution.status is SolutionStatus.LOCALLY_INFEASIBLE
    assert any("contradict" in line for line in solution.warnings)
    assert solution.solver.residuals[0].name in ("boundary span", "bound x")


def test_an_ordinary_problem_loses_nothing() -> None:
    assert solved(block()).warnings == []
