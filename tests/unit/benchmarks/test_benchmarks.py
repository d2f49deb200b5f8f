"""What the comparisons rest on: the same equations for all, fair settings, a chain that is one."""

from itertools import pairwise
from math import cos, sin
from typing import Any

import numpy as np
import pytest

import examples
from benchmarks.chain import DISTANCE, STIFFNESS, chain
from benchmarks.growth import Point, exponent
from benchmarks.peers.measuring import Solved, Tool, _search, ladder
from benchmarks.peers.problems import PROBLEMS, Problem
from schemas.reading import read_problem
from schemas.resolve import interval
from schemas.systems import Ode
from solver.lowering import lower
from solver.numeric import dynamics


def value(text: Any, names: dict[str, float]) -> float:
    return float(eval(str(text).replace("^", "**"), {"__builtins__": {}}, names))  # noqa: S307 - our own chain


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_peers_solve_the_examples(name: str) -> None:
    ours, theirs = read_problem(examples.load(name)), PROBLEMS[name]
    (phase,), (form,) = ours.phases, lower(ours)
    rates, random = dynamics(form), np.random.default_rng(1)
    for _ in range(5):
        x = random.uniform(-2, 2, len(form.states))
        u = random.uniform(-2, 2, len(form.controls))
        own = theirs.rate(x.tolist(), u.tolist(), sin, cos)
        np.testing.assert_allclose(own, rates(0.0, x, u), rtol=1e-12, atol=1e-12)
    assert theirs.duration == interval(phase.time.final, {})[0]
    for given, values in ((phase.initial, theirs.start), (phase.final, theirs.end)):
        assert [interval(given[state], {})[0] for state in form.states] == list(values)
    names = [*form.states, *form.controls]
    assert [interval(phase.bounds.get(n), {}) for n in names] == list(theirs.bounds)
    assert theirs.optimum == ours.known[0].value
    (integrand,) = phase.integrals.values()
    assert str(integrand).replace(" ", "") == "+".join(f"{u}^2" for u in form.controls)


def test_a_ladder_grows_by_a_fifth() -> None:
    rungs = ladder(5, 400)
    assert (rungs[0], rungs[-1]) == (5, 400)
    assert all(a < b <= max(a + 1, 1.35 * a) for a, b in pairwise(rungs))
    assert ladder(1, 8) == list(range(1, 9))


def test_an_error_that_only_changes_its_sign_is_not_good_enough() -> None:
    errors = {1: 1e-2, 2: 1e-9, 3: -1e-3, 4: 1e-6, 5: 1e-7, 6: 1e-8}

    def solve(problem: Problem, family: str, setting: int) -> Solved:
        objective = problem.optimum * (1 + errors[setting])
        return Solved(objective, 1.0 if family == "slow" else 0.5, 0.1, None)

    problem = PROBLEMS["cart_pole"]
    tool = Tool(solve, {"slow": list(errors), "fast": list(errors), "never": [1, 2, 3]})
    found = _search(tool, problem, 10.0, list(tool.families))
    assert found == {"family": "fast", "setting": 4}
    assert _search(tool, problem, 10.0, ["never"]) is None


@pytest.mark.parametrize("masses", [1, 2, 30])
def test_the_chain_is_a_problem_of_two_states_a_mass(masses: int) -> None:
    system = read_problem(chain(masses, 10)).phases[0].system
    assert isinstance(system, Ode)
    assert len(system.states) == 2 * masses


def test_only_the_push_moves_the_whole_chain() -> None:
    derivatives = chain(3, 10)["phases"][0]["system"]["derivatives"]
    names = {"x1": 0.1, "x2": -0.2, "x3": 0.4, "k": STIFFNESS, "m": 1.0, "u": 3.0}
    forces = [value(derivatives[f"v{i}"], names) for i in (1, 2, 3)]
    assert sum(forces) == pytest.approx(3.0)
    still = names | {f"x{i}": DISTANCE for i in (1, 2, 3)} | {"u": 0.0}
    assert [value(derivatives[f"v{i}"], still) for i in (1, 2, 3)] == [0.0, 0.0, 0.0]


def test_the_exponent_is_the_slope_without_small_sizes_and_time_limits() -> None:
    sweep = [Point(n, 2e-3 * n**1.5, 0.0, 1, "converged") for n in (100, 200, 400)]
    early, late = Point(25, 9.0, 0.0, 1, "converged"), Point(800, 1e-9, 0.0, 1, "time_limit")
    assert exponent([early, *sweep, late], 100, "seconds") == pytest.approx(1.5)
