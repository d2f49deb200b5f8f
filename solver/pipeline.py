"""The whole story on one page: problem -> starts -> stages -> meshes -> certificate -> solution."""

import math
import time
from collections.abc import Callable

from schemas.events import EngineEvent
from schemas.problem import Problem
from schemas.results import Solution
from solver.backends.memory import memory_told
from solver.campaign import solve_guesses, solve_polished, solve_stages
from solver.once import solve_once
from solver.run import Run


def _ignore(_: object) -> None:
    """Take no notice."""


def _never() -> bool:
    return False


def solve(
    problem: Problem,
    on_event: Callable[[EngineEvent], None] = _ignore,
    deadline: float | None = None,
    should_stop: Callable[[], bool] = _never,
    on_snapshot: Callable[[Solution], None] = _ignore,
) -> Solution:
    """Solve a checked problem.

    Parameters
    ----------
    problem
        As ``schemas.reading.read_problem`` gives it.
    on_event
        Called with every stage, NLP iteration and solved mesh.
    deadline
        When to end at the latest, in seconds of ``time.monotonic``; the problem's own limit
        counts too.
    should_stop
        Asked at every NLP iteration; true ends the solve with the best iterate.
    on_snapshot
        Called with an uncertified solution after each mesh and, in long solves, about every
        second, so that a killed solve leaves one.

    Returns
    -------
    The solution, whatever its status. Its times are SI seconds of the motion.

    Raises
    ------
    InvalidModel
        If the model has no finite value at the initial guess.
    EngineFault
        If the NLP solver itself fails.
    """
    limit = time.monotonic() + problem.limits.seconds
    run = Run(on_event, min(limit, math.inf if deadline is None else deadline), should_stop)

    def once(problem: Problem, run: Run) -> Solution:
        return solve_once(problem, run, on_snapshot)

    def polished(problem: Problem, run: Run) -> Solution:
        return solve_polished(problem, once, run)

    def staged(problem: Problem, run: Run) -> Solution:
        return solve_stages(problem, polished, run)

    with memory_told():
        return solve_guesses(problem, staged, run)
