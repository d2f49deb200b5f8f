"""Inequalities that the equalities at an end decide are dropped: nothing lies inside of them."""

from typing import Any

import pytest

from schemas.reading import read_problem
from schemas.results import SolutionStatus
from solver.nlp.decided import decided_rows
from solver.nlp.scaling import typical_scaling
from solver.nlp.task import NlpTask
from solver.prepare import prepare
from solver.transcribe import transcribe
from tests.unit.solver.problems import block, solved


def dropped(document: dict[str, Any]) -> list[tuple[str, float]]:
    """Name and fraction of each inequality that is decided."""
    program = transcribe(*prepare(read_problem(document))).program
    scaling = typical_scaling(program)
    rows = decided_rows(program, scaling, NlpTask.of(program, scaling).nlp)
    labels = list(program.labels())
    return [(labels[row].name, labels[row].fraction) for row in rows]


def touching(
    lower: float | None = None, upper: float | None = None, **phase: Any
) -> dict[str, Any]:
    """The block from 0 to 1, with limits of a nonlinear path constraint."""
    row = {"name": "where", "expression": "(x + 1)^2", "lower": lower, "upper": upper}
    return block(phase={"path": [row], **phase})


def test_a_limit_is_touched_by_fixed_values_at_both_ends() -> None:
    assert dropped(touching(1, 4)) == [("path where", 0.0), ("path where", 1.0)]


def test_a_limit_that_fixed_values_break_is_kept() -> None:
    assert dropped(touching(upper=3)) == [("path where", 0.0)]
    assert solved(touching(upper=3)).status is SolutionStatus.LOCALLY_INFEASIBLE


@pytest.mark.parametrize("scale", [1.0, -3.0])
def test_a_boundary_equality_decides_the_path_constraint_of_its_expression(scale: float) -> None:
    """However it is scaled, and although none of its variables is fixed."""
    expression = f"{scale}*(final.u^2 + final.t)"
    equality = {"name": "b", "expression": expression, "lower": 5 * scale, "upper": 5 * scale}
    path = {"name": "p", "expression": "u^2 + t", "lower": None, "upper": 5}
    found = dropped(block(phase={"boundary": [equality], "path": [path]}))
    assert found == [("path p", 1.0)]


def test_an_ordinary_inequality_is_kept() -> None:
    path = {"name": "p", "expression": "u^2 + v", "lower": None, "upper": 100}
    assert dropped(block(phase={"path": [path]})) == []


def test_where_there_is_no_inside_the_solver_takes_no_longer() -> None:
    """Without this, its multipliers grow to 1e9 before it lets go, which takes nine iterations."""
    plain, tight = solved(block()), solved(touching(1, 4))
    assert tight.status is SolutionStatus.CONVERGED
    assert tight.objective == pytest.approx(plain.objective, rel=1e-6)
    assert tight.solver.iterations <= plain.solver.iterations + 6
