"""The backend seam: what every backend solves, statuses, the watch, the best iterate."""

import time
from typing import Any

import numpy as np
import pytest

import examples
from schemas.results import SolutionStatus
from solver.backends import BACKENDS, FEASIBLE, NlpStatus, Watch
from solver.backends.ipopt import STATUSES
from solver.backends.watch import Iterate, StopCause
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


def watch(**changes: object) -> Watch:
    settings = {
        "deadline": time.monotonic() + 60,
        "should_stop": lambda: False,
        "report": lambda *_: None,
    }
    return Watch(**(settings | changes))  # type: ignore[arg-type]


def test_every_outcome_of_ipopt_has_a_neutral_status() -> None:
    assert set(STATUSES) == IPOPT_OUTCOMES
    assert set(STATUSES.values()) | {NlpStatus.UNBOUNDED} == set(NlpStatus)


PROBLEMS: list[tuple[dict[str, Any], SolutionStatus, float | None]] = [
    (block(), SolutionStatus.CONVERGED, 12.0),
    (examples.load("linear_quadratic"), SolutionStatus.CONVERGED, 0.380797077977881),
    (examples.load("double_integrator"), SolutionStatus.CONVERGED, 2.0),
    (block(phase={"bounds": {"u": [-3, 3]}}), SolutionStatus.LOCALLY_INFEASIBLE, None),
    (block(solver={"max_iterations": 0}), SolutionStatus.ITERATION_LIMIT, None),
]
"""For every backend: a problem, how it ends, and its optimum where it has one."""


@pytest.mark.parametrize("backend", BACKENDS)
def test_every_backend_is_available_where_tests_run(backend: str) -> None:
    assert BACKENDS[backend]().available()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("document", "status", "optimum"), PROBLEMS)
def test_every_backend(
    backend: str, document: dict[str, Any], status: SolutionStatus, optimum: float | None
) -> None:
    settings = document.get("solver", {}) | {"backend": backend}
    solution = solved(document | {"solver": settings})
    assert solution.status is status, solution.message
    assert optimum is None or solution.objective == pytest.approx(optimum, rel=1e-5)


def test_best_is_the_least_violation_until_feasible_then_the_lowest_objective() -> None:
    seen = watch()
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
    seen = watch()
    seen.see(iterate(float("nan"), 0.0))
    seen.see(iterate(1.0, float("inf")))
    assert seen.best is None


def test_the_cause_of_a_stop_is_recorded() -> None:
    late = watch(deadline=time.monotonic() - 1)
    assert late.see(iterate(0, 0))
    assert late.cause is StopCause.DEADLINE
    asked = watch(should_stop=lambda: True)
    assert asked.see(iterate(0, 0))
    assert asked.cause is StopCause.REQUEST


def test_a_fault_of_a_callback_stops_and_is_kept() -> None:
    def fail() -> bool:
        raise LookupError("gone")

    broken = watch(should_stop=fail)
    assert broken.see(iterate(0, 0))
    assert isinstance(broken.fault, LookupError)
