"""The backend seam: what every backend solves, statuses, the watch, the best iterate."""

import time
from typing import Any

import numpy as np
import pytest

import examples
from schemas.results import SolutionStatus
from solver.backends import BACKENDS, FEASIBLE, NlpStatus
from solver.backends.ipopt import STATUSES
from solver.backends.watch import Iterate, StopCause
from tests.backends.tasks import (
    INFEASIBLE,
    UNBOUNDED,
    after,
    example,
    posed,
    run,
    watched,
)
from tests.unit.solver.problems import block, solved

IPOPT_OUTCOMES = {
    "Solve_Succeeded",
    "Solved_To_Acceptable_Level",
    "Infeasible_Problem_Detected",
    "Search_Direction_Becomes_Too_Small",
    "Diverging_Iterates",
    "User_Requested_Stop",
    "Feasible_Point_Found",
    "Maximum_Iterations_Exceeded",
    "Restoration_Failed",
    "Error_In_Step_Computation",
    "Maximum_CpuTime_Exceeded",
    "Maximum_WallTime_Exceeded",
    "Not_Enough_Degrees_Of_Freedom",
    "Invalid_Number_Detected",
}
"""All return codes of IPOPT but for faults (options, definitions, memory, exceptions)."""


def iterate(objective: float, violation: float) -> Iterate:
    return Iterate(np.array([objective]), np.array([]), objective, violation)


def test_every_outcome_of_ipopt_has_a_neutral_status() -> None:
    assert set(STATUSES) == IPOPT_OUTCOMES
    assert set(STATUSES.values()) | {NlpStatus.UNBOUNDED} == set(NlpStatus)


Case = tuple[dict[str, Any], NlpStatus, float | None]

PROBLEMS: dict[str, Case] = {
    "block": (block(), NlpStatus.OPTIMAL, 12.0),
    "linear_quadratic": (
        examples.load("linear_quadratic"),
        NlpStatus.OPTIMAL,
        0.380797078264,
    ),
    "cart_pole": (example("cart_pole", segments=20), NlpStatus.OPTIMAL, 58.70266878),
    "cart_pole, trapezoidal": (
        example("cart_pole", kind="trapezoidal", segments=40),
        NlpStatus.OPTIMAL,
        59.3255360,
    ),
    "cart_pole, radau": (
        example("cart_pole", kind="radau", segments=10, points=4),
        NlpStatus.OPTIMAL,
        58.6806341,
    ),
    "free time": (example("double_integrator", segments=21), NlpStatus.OPTIMAL, 2.0007563),
    "free time, nonlinear": (examples.load("brachistochrone"), NlpStatus.OPTIMAL, 0.82433867),
    "state bound": (examples.load("bryson_denham"), NlpStatus.OPTIMAL, 4.0),
    "infeasible": (INFEASIBLE, NlpStatus.INFEASIBLE, None),
    "unbounded": (UNBOUNDED, NlpStatus.UNBOUNDED, None),
}
"""A problem, how its first mesh ends with every backend, and its optimum there."""

OTHERWISE = {
    ("sqp", "infeasible"): NlpStatus.DIVERGED,
    ("sqp", "unbounded"): NlpStatus.DIVERGED,
}
"""What a backend cannot tell: of either, the plain SQP knows that its violation falls no more."""

ASTRAY = {("sqp", case) for case in PROBLEMS if case.startswith("cart_pole") or "nonlinear" in case}
"""Nonlinear motions, on which the plain SQP may find another minimum, or cycle and say so."""


@pytest.mark.parametrize("backend", BACKENDS)
def test_every_backend_is_available_where_tests_run(backend: str) -> None:
    assert BACKENDS[backend]().available()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", PROBLEMS)
def test_every_backend_solves(backend: str, case: str) -> None:
    document, status, optimum = PROBLEMS[case]
    task = posed(document).task
    assert BACKENDS[backend]().refusal(task) == ""
    outcome = run(backend, task)
    expected = OTHERWISE.get((backend, case), status)
    if (backend, case) in ASTRAY and outcome.status is NlpStatus.DIVERGED:
        return
    assert outcome.status is expected, outcome.raw
    if optimum is not None:
        if (backend, case) not in ASTRAY:
            assert outcome.point.objective == pytest.approx(optimum, rel=1e-6)
        assert outcome.point.violation <= 1e-7
        z, rows = outcome.point.z, outcome.point.rows
        assert max((task.lower - z).max(), (z - task.upper).max()) <= 1e-7
        assert task.nlp.evaluate(z)[1].full().ravel() == pytest.approx(rows, abs=1e-12)


@pytest.mark.parametrize(
    ("backend", "case"),
    [
        (backend, case)
        for backend in BACKENDS
        for case in ("linear_quadratic", "cart_pole", "free time", "state bound")
        if (backend, case) not in ASTRAY
    ],
)
def test_multipliers_make_the_gradient_of_the_lagrangian_vanish(backend: str, case: str) -> None:
    task = posed(PROBLEMS[case][0]).task
    outcome = run(backend, task)
    assert outcome.row_multipliers is not None
    assert outcome.bound_multipliers is not None
    slope = task.nlp.gradient(outcome.point.z, [])[1].full().ravel()
    jacobian = task.nlp.jacobian(outcome.point.z, [])[1].sparse()
    rest = slope + jacobian.T @ outcome.row_multipliers + outcome.bound_multipliers
    assert np.abs(rest).max() <= 1e-5


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("limit", [0, 3])
def test_an_iteration_limit_gives_the_best_iterate(backend: str, limit: int) -> None:
    seen = watched()
    outcome = run(backend, posed(PROBLEMS["cart_pole"][0]).task, seen, iterations=limit)
    assert outcome.status is NlpStatus.ITERATION_LIMIT
    assert outcome.iterations <= limit + 1
    assert outcome.point is seen.best


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("case", "calls"),
    [
        *((case, n) for case in ("infeasible", "unbounded", "free time") for n in (0, 1)),
        *(("cart_pole", n) for n in (0, 2, 6, 9)),
    ],
)
def test_a_stop_is_heard_at_the_next_iteration(backend: str, case: str, calls: int) -> None:
    seen = watched(should_stop=after(calls))
    outcome = run(backend, posed(PROBLEMS[case][0]).task, seen)
    assert outcome.status is NlpStatus.STOPPED
    # Fatrop ends by failing, and may look at a few points more.
    assert seen.iterations <= calls + (4 if backend == "fatrop" else 1)
    assert outcome.point is seen.best


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_deadline_ends_the_solve(backend: str) -> None:
    task = posed(example("moon_landing", segments=400)).task
    outcome = run(backend, task, watched(deadline=time.monotonic() + 0.002))
    assert outcome.status is NlpStatus.TIME_LIMIT


@pytest.mark.parametrize("backend", BACKENDS)
def test_an_error_of_the_watch_comes_out(backend: str) -> None:
    def fail() -> bool:
        raise LookupError("gone")

    with pytest.raises(LookupError, match="gone"):
        run(backend, posed(block()).task, watched(should_stop=fail))


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_number_on_the_way_is_survived_or_told(backend: str) -> None:
    # Without the root, the block moves at 1.5 m/s.
    system = {"derivatives": {"x": "v", "v": "u + sqrt(1.3 - v)"}}
    outcome = run(backend, posed(block(system=system)).task)
    assert np.isfinite(outcome.point.objective)
    if outcome.status is NlpStatus.OPTIMAL:
        assert outcome.point.violation <= 1e-7
    else:
        told = (NlpStatus.INVALID_NUMBER, NlpStatus.INFEASIBLE, NlpStatus.DIVERGED)
        assert outcome.status in told


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_solve_writes_nothing(backend: str, capfd: pytest.CaptureFixture[str]) -> None:
    run(backend, posed(block()).task)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_whole_engine_with_every_backend(backend: str) -> None:
    solution = solved(block(solver={"backend": backend}))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.objective == pytest.approx(12.0, rel=1e-6)
    assert solution.solver.backend == backend


def test_best_is_the_least_violation_until_feasible_then_the_lowest_objective() -> None:
    seen = watched()
    for objective, violation in [
        (1, 1.0),
        (9, 0.1),
        (8, 0.5),
        (7, FEASIBLE / 2),
        (6, 0.0),
        (9, 0.0),
    ]:
        assert not seen.see(iterate(objective, violation))
    assert seen.best is not None
    assert (seen.best.objective, seen.best.violation) == (6, 0.0)
    assert seen.iterations == 5


def test_an_iterate_that_is_no_number_is_never_the_best() -> None:
    seen = watched()
    seen.see(iterate(float("nan"), 0.0))
    seen.see(iterate(1.0, float("inf")))
    assert seen.best is None


def test_the_cause_of_a_stop_is_recorded() -> None:
    late = watched(deadline=time.monotonic() - 1)
    assert late.see(iterate(0, 0))
    assert late.cause is StopCause.DEADLINE
    asked = watched(should_stop=lambda: True)
    assert asked.see(iterate(0, 0))
    assert asked.cause is StopCause.REQUEST


def test_a_fault_of_a_callback_stops_and_is_kept() -> None:
    def fail() -> bool:
        raise LookupError("gone")

    broken = watched(should_stop=fail)
    assert broken.see(iterate(0, 0))
    assert isinstance(broken.fault, LookupError)
