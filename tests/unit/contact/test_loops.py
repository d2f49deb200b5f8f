"""Closed loops by time steps: a pin holds at every step's end, and from the start."""

import pytest

import examples
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve


def turned(segments: int, way: str = "discrete_gradient") -> Solution:
    """One turn of a four-bar's crank, which collocation does for 1.835994."""
    method = {"kind": "contact_implicit", "segments": segments, "discretisation": way}
    return solve(read_problem(examples.load("four_bar") | {"method": method, "refinement": None}))


def test_a_four_bar_turns_once() -> None:
    """Errors of the first order: a quarter of the step, less than half of the error."""
    coarse, fine = turned(160), turned(640)
    for one in (coarse, fine):
        assert one.status is SolutionStatus.CONVERGED, one.message
    errors = [abs((one.objective or 0.0) - 1.835994) for one in (coarse, fine)]
    assert errors[1] < errors[0] / 2
    assert errors[1] < 0.035
    forces = fine.phases[0].groups["forces"].values
    assert set(forces) == {"loop.pin.x", "loop.pin.y"}


def test_backward_euler_closes_loops_too() -> None:
    checks = {check.name: check for check in turned(160, "backward_euler").certificate.checks}
    assert checks["loops at knots"].passed
    assert checks["equations of motion"].passed


def test_an_earlier_result_on_another_mesh_is_a_guess() -> None:
    coarse = turned(40)
    curves = {name: group.model_dump() for name, group in coarse.phases[0].curves.items()}
    guess = {"kind": "solution", "phases": [{"name": "turn", "curves": curves}]}
    method = {"kind": "contact_implicit", "segments": 80}
    document = examples.load("four_bar") | {"method": method, "refinement": None, "guess": guess}
    solution = solve(read_problem(document))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.objective == pytest.approx(turned(80).objective, rel=1e-6)
