"""What one method found is where any other starts; what it left out takes the linear guess."""

import itertools
from typing import Any

import numpy as np
import pytest

from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver.prepare import prepare
from solver.trajectory import Trajectory
from tests.unit.solver.motions import IMPLICIT, move, problem
from tests.unit.solver.problems import solved

METHODS: list[dict[str, Any]] = [
    {"kind": "radau", "segments": 4},
    {"kind": "dircol5i", "segments": 6},
    {"kind": "hermite_simpson", "segments": 12},
    {"kind": "multiple_shooting", "segments": 8},
]
SWING: dict[str, Any] = {**IMPLICIT, "residual": ["dd(q) + 5*sin(q) - u"]}


def guess_of(solution: Solution, *left_out: str) -> dict[str, Any]:
    """A result as a client posts it, without some of its series."""
    phases = []
    for phase in solution.phases:
        curves = {name: group.model_dump() for name, group in phase.curves.items()}
        for group in curves.values():
            for name in left_out:
                group["coefficients"].pop(name, None)
        phases.append({"name": phase.name, "curves": curves})
    return {"kind": "solution", "phases": phases, "static": dict(solution.static)}


def swing(method: dict[str, Any], **changes: Any) -> dict[str, Any]:
    smooth = move(system=SWING, final={"q": 3, "d(q)": 0}, integrals={"effort": "u^2 + d(u)^2/99"})
    return problem(smooth, method=method, **changes)


@pytest.mark.parametrize(("one", "two"), list(itertools.permutations(METHODS, 2)), ids=str)
def test_from_method_to_method(one: dict[str, Any], two: dict[str, Any]) -> None:
    first = solved(swing(one))
    cold, warm = solved(swing(two)), solved(swing(two, guess=guess_of(first)))
    assert warm.status is SolutionStatus.CONVERGED
    assert warm.objective == pytest.approx(cold.objective, rel=1e-6)
    assert warm.solver.iterations <= cold.solver.iterations
    (mine,), (theirs,) = (trajectories(swing(two, guess=guess_of(first))), first.phases)
    nodes = theirs.groups["states"]
    fractions = np.array(nodes.time)
    np.testing.assert_allclose(
        mine.sample(["q"], fractions)[0], listed(nodes.values["q"]), atol=1e-9
    )


def listed(values: list[float | None]) -> Any:
    """The values as numbers."""
    return np.array(values, dtype=float)


def trajectories(document: dict[str, Any]) -> list[Trajectory]:
    return list(prepare(read_problem(document))[1].guesses)


THIRDS = np.array([0.0, 0.5, 1.0])


def test_what_an_earlier_result_lacks_takes_the_linear_guess() -> None:
    guess = guess_of(solved(problem(move())), "d(q)", "u")
    system = {
        "kind": "ode",
        "states": ["q", "w"],
        "controls": ["u"],
        "derivatives": {"q": "u", "w": "1"},
    }
    wider = move(system=system, initial={"q": 0, "w": 2}, final={"w": 3, "u": 5})
    (found,) = trajectories(problem(wider, guess=guess))
    np.testing.assert_allclose(
        found.sample(["q", "w", "u"], THIRDS),
        np.array([[0, 0.5, 1], [2, 2.5, 3], [5, 5, 5.0]]),
        atol=1e-6,
    )


def test_a_guess_without_states() -> None:
    guess = guess_of(solved(problem(move())))
    del guess["phases"][0]["curves"]["states"]
    (found,) = trajectories(problem(move(), guess=guess))
    np.testing.assert_allclose(
        found.sample(["q", "u"], THIRDS), np.array([[0, 0.5, 1], [6, 0, -6.0]]), atol=1e-6
    )


def test_phases_are_matched_by_name_alone() -> None:
    guess = guess_of(solved(problem(move("a"))))
    second = move("b", time={"duration": 1}, initial={"q": 7}, final={"q": 5})
    found = trajectories(problem(move("a"), second, guess=guess))
    np.testing.assert_allclose(found[1].sample(["q"], THIRDS), [[7, 6, 5]])


def test_segments_of_several_degrees_meet_in_one_value() -> None:
    """At a knot a jump has the value of the segment that begins there, as in the curves."""
    system = {**IMPLICIT, "residual": ["dd(q) + 40*q^3 - u"]}
    phase = move(system=system, bounds={"u": [-30, 30]}, final={"q": 2, "d(q)": 0})
    refinement = {"tolerance": 1e-7, "max_iterations": 4}
    solution = solved(problem(phase, refinement=refinement))
    assert len(set(solution.mesh_refinement.iterations[-1].degrees)) > 1
    (found,) = trajectories(problem(phase, guess=guess_of(solution)))
    group = solution.phases[0].groups["controls"]
    curve = found.controls["u"]
    np.testing.assert_allclose(curve(np.array(group.time)), listed(group.values["u"]), atol=1e-9)
