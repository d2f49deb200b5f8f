"""Contacts are kept in place on the mesh, and at no cost of accuracy."""

from typing import Any

import numpy as np
import pytest

from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve
from tests.unit.hybrid.documents import flat_foot, pendulum, wheel

METHODS: list[dict[str, Any]] = [
    {"kind": "hermite_simpson", "segments": 20},
    {"kind": "hermite_simpson", "segments": 20, "form": "compressed"},
    {"kind": "radau", "segments": 6, "points": 3},
    {"kind": "trapezoidal", "segments": 40},
]


def solved(document: dict[str, Any]) -> Solution:
    return solve(read_problem(document))


def largest(solution: Solution, *names: str) -> float:
    """Over all nodes of the first phase."""
    values = solution.phases[0].groups["states"].values
    return max(abs(value) for name in names for value in values[name] if value is not None)


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_a_foot_at_rest_does_not_drift(method: dict[str, Any]) -> None:
    solution = solved(pendulum(pinned=False, method=method))
    assert solution.solver.status == "Solve_Succeeded"
    assert largest(solution, "rod.x", "rod.y") < 1e-10
    assert largest(solution, "rod.d(x)", "rod.d(y)") < 1e-10


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_held_by_forces_as_by_a_hinge(method: dict[str, Any]) -> None:
    """The same motion in minimal coordinates."""
    pinned, held = (solved(pendulum(pinned=one, method=method)) for one in (True, False))
    assert held.objective == pytest.approx(pinned.objective, rel=1e-6)


def test_the_forces_bear_the_rod() -> None:
    """From rest to rest: the impulse of the forces is that of the weight."""
    document = pendulum(pinned=False, method={"kind": "radau", "segments": 12, "points": 4})
    document["phases"][0]["integrals"] |= {
        "up": "contact.pin.normal",
        "along": "contact.pin.tangential",
    }
    solution = solved(document)
    assert solution.phases[0].integrals["up"] == pytest.approx(9.81 * 0.7, rel=1e-7)
    assert solution.phases[0].integrals["along"] == pytest.approx(0, abs=1e-6)
    assert "contact.pin.normal" in solution.phases[0].groups["forces"].values


def test_toe_and_heel_of_one_foot() -> None:
    """Their tangential forces are two for one row; nothing of it is singular."""
    solution = solved(flat_foot({"toe": "sticking", "heel": "sticking"}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.solver.iterations < 30
    assert largest(solution, "foot.y", "foot.angle") < 1e-10
    forces = solution.phases[0].groups["forces"].values
    weight = np.array(forces["contact.toe.normal"]) + np.array(forces["contact.heel.normal"])
    assert np.mean(weight) == pytest.approx(6 * 9.81, rel=1e-2)


def test_a_foot_that_tips_over_its_toe_is_free_to_turn() -> None:
    document = flat_foot({"toe": "sticking"}) | {"refinement": {"tolerance": 1e-5}}
    solution = solved(document)
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert largest(solution, "foot.angle") > 1e-3


@pytest.mark.parametrize(("slope", "height"), [(0.0, "0"), (-0.2, "-0.2*x")])
def test_a_wheel_rolls_as_far_as_it_turns(slope: float, height: str) -> None:
    """On level and on straight ground its place is held, and not its rate alone."""
    solution = solved(wheel(height))
    values = solution.phases[0].groups["states"].values
    rolled, length = np.array(values["wheel.angle"]), np.hypot(1, slope)
    assert np.abs(0.1 * rolled + length * np.array(values["wheel.x"])).max() < 1e-10
    # least effort from rest to rest is linear in time, 12 (M d)^2; the weight comes on top
    mass, way = 2 + 0.02 / 0.1**2, 0.5 * length
    torque = 0.1 * 2 * 9.81 * slope / length
    assert solution.objective == pytest.approx(
        (0.1 * mass) ** 2 * 12 * way**2 + torque**2, rel=1e-6
    )


def test_a_wheel_rolls_over_hills() -> None:
    """Curved ground has no place to hold: the rate alone is."""
    solution = solved(wheel("0.1*sin(3*x)"))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert largest(solution, "wheel.d(x)") > 0.1
