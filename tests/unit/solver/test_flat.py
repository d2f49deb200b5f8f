"""A model without curvature: the question whether its point is an optimum has an answer."""

from schemas.reading import read_problem
from solver import solve
from tests.support.service import BLOCK


def test_an_objective_without_curvature_ends_with_advice() -> None:
    phase = BLOCK["phases"][0] | {
        "time": {"final": 3},
        "bounds": {"u": [-1, 1]},
        "integrals": {"effort": "abs(u)"},
    }
    solution = solve(read_problem(BLOCK | {"phases": [phase], "refinement": None}))
    assert any("is not smooth" in line for line in solution.warnings)
    assert solution.status == "converged" or "nonsmooth" in solution.advice[0]
