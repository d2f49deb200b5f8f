"""Equalities that follow from others are dropped and reported; contradictions are told apart."""

import time
from typing import Any

import pytest

import examples
from schemas.reading import read_problem
from schemas.results import SolutionStatus
from solver.nlp.redundancy import Redundancy, find_redundancy
from solver.nlp.scaling import typical_scaling
from solver.nlp.task import NlpTask
from solver.prepare import prepare
from solver.transcribe import transcribe
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


def found(document: dict[str, Any]) -> Redundancy:
    problem = read_problem(document)
    program = transcribe(*prepare(problem)).program
    scaling = typical_scaling(program)
    return find_redundancy(program, scaling, NlpTask.of(program, scaling).nlp)


def in_free_time(*boundary: str, segments: int = 10) -> dict[str, Any]:
    """The double integrator of free final time, with expressions that shall be zero at its ends."""
    document = examples.load("double_integrator")
    document["phases"][0]["boundary"] = [
        {"name": f"row{index}", "expression": expression, "lower": 0, "upper": 0}
        for index, expression in enumerate(boundary)
    ]
    return document | {"method": {"kind": "hermite_simpson", "segments": segments}}


@pytest.mark.parametrize(
    ("boundary", "names"),
    [
        ((), ()),
        (("duration - 2",), ()),
        (("duration - 2", "2*duration - 4"), ("boundary row1",)),
        (("final.u + duration - 1", "2*final.u + 2*duration - 2"), ("boundary row1",)),
    ],
)
def test_a_time_that_all_rows_share(boundary: tuple[str, ...], names: tuple[str, ...]) -> None:
    assert found(in_free_time(*boundary)).names == names


def test_a_free_time_costs_no_more_than_a_fixed_one() -> None:
    """Its column would fill A A': the cube of 8000 rows is minutes, not a tenth of a second."""
    began = time.perf_counter()
    assert found(in_free_time(segments=2000)).names == ()
    assert time.perf_counter() - began < 5


def test_one_at_every_node_is_named_once() -> None:
    path = {"name": "twice", "expression": "u - 2*u + u", "lower": 0, "upper": 0}
    redundancy = found(block(phase={"path": [path]}))
    assert redundancy.names == ("path twice",)
    assert len(redundancy.rows) > 10


def test_a_model_without_a_value_near_its_guess_is_left_alone() -> None:
    rows = [
        {"name": name, "expression": "sqrt(-1 - final.v^2)", "lower": 0, "upper": 0}
        for name in ("a", "b")
    ]
    assert found(block(phase={"boundary": rows})).names == ()
