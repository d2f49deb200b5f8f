"""The certificate over what the engine itself publishes."""

from typing import Any

import pytest

import examples
from schemas.reading import read_problem
from schemas.results import Check, Solution
from solver import solve


def solved(method: dict[str, Any]) -> Solution:
    """The quickest metre with abs(u) <= 1: bang-bang, T = 2, on one mesh."""
    document = examples.load("double_integrator") | {"method": method, "refinement": None}
    return solve(read_problem(document))


def overshoot(solution: Solution) -> Check:
    return next(row for row in solution.certificate.checks if row.name == "control overshoot")


def test_a_polynomial_that_rings_between_its_nodes_is_refused() -> None:
    """It keeps the bounds at every node, and buys a time below the true one in between."""
    solution = solved({"kind": "chebyshev_lobatto", "degree": 24})
    assert solution.status == "certificate_failed"
    assert (overshoot(solution).value or 0) > 0.01


def test_a_quadratic_control_keeps_its_bounds_between_the_nodes() -> None:
    """By its corners, at the price of a little time where it has to jump."""
    solution = solved({"kind": "hermite_simpson", "segments": 20})
    assert solution.status == "converged"
    assert overshoot(solution).value == pytest.approx(0, abs=1e-8)
    assert 2 < (solution.objective or 0) < 2.01


def test_a_linear_control_cannot_cheat() -> None:
    solution = solved({"kind": "hermite_simpson", "segments": 20, "control": "linear"})
    assert solution.status == "converged"
    assert overshoot(solution).value == pytest.approx(0, abs=1e-8)
