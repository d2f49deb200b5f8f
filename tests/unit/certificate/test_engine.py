"""The certificate over what the engine itself publishes."""

import pytest

import examples
from schemas.reading import read_problem
from schemas.results import Check, Solution
from solver import solve


def solved(segments: int, control: str) -> Solution:
    """The quickest metre with abs(u) <= 1: bang-bang, T = 2, on one mesh."""
    method = {"kind": "hermite_simpson", "segments": segments, "control": control}
    document = examples.load("double_integrator") | {"method": method, "refinement": None}
    return solve(read_problem(document))


def overshoot(solution: Solution) -> Check:
    return next(row for row in solution.certificate.checks if row.name == "control overshoot")


def test_a_quadratic_control_that_cheats_between_its_nodes_is_refused() -> None:
    """T = 2 is the true optimum, reached on a mesh that cannot: u swings to 1.125."""
    solution = solved(20, "quadratic")
    assert solution.objective == pytest.approx(2, abs=1e-6)
    assert solution.status == "certificate_failed"
    assert overshoot(solution).value == pytest.approx(0.125 / 2, rel=0.01)


def test_a_linear_control_cannot_cheat() -> None:
    solution = solved(20, "linear")
    assert solution.status == "converged"
    assert overshoot(solution).value == pytest.approx(0, abs=1e-8)
