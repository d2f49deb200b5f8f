"""Many guesses in one job: the best of what they lead to, and all distinct minima."""

import dataclasses
import time

from schemas.events import StageStarted
from schemas.guesses import Guess, PosesGuess, RandomGuess
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import Solution
from solver.campaign.minima import FOUND, distinct, rank
from solver.campaign.once import SolveOnce
from solver.run import Run

OWN = 0
"""The seed by which the problem's own guess is told, where that is not a random one."""

_SPREAD = 0.05
"""Of the noise about key poses, of which the problem's bounds are seldom the scale."""


def solve_guesses(problem: Problem, solve: SolveOnce, run: Run) -> Solution:
    """Solve a problem from ``problem.multistart`` guesses; from its own where that is one.

    The time that is left is shared by the guesses that are left. Where the run is stopped, what
    was found so far counts.

    Returns
    -------
    The best solution, with the distinct minima and the share of guesses that led to any motion.
    Where none did, the first one's solution.
    """
    count = problem.multistart
    if count == 1:
        return solve(problem, run)
    found: list[tuple[int, Solution]] = []
    for number in range(count):
        seed, start = started(problem, number)
        run.on_event(StageStarted(stage="build", note=f"guess {number + 1} of {count}"))
        found.append((seed, solve(start, _share(run, count - number))))
        if run.stopped():
            break
    return _concluded(problem, found, run)


def started(problem: Problem, number: int) -> tuple[int, Problem]:
    """The seed and the problem of guess ``number``, which counts from 0.

    The first is the problem's own guess; then random ones, in phases with guesses of their own,
    too, about key poses where it has them. The seeds of a random guess count on from its own.
    """
    own = problem.guess
    first = own.seed if isinstance(own, RandomGuess) else OWN
    if number == 0:
        return first, problem
    phases = [
        phase
        if phase.guess is None
        else phase.model_copy(update={"guess": _random(phase.guess, number)})
        for phase in problem.phases
    ]
    return first + number, problem.model_copy(
        update={"guess": _random(own, number), "phases": phases}
    )


def _random(guess: Guess, number: int) -> RandomGuess:
    if isinstance(guess, RandomGuess):
        return guess.model_copy(update={"seed": guess.seed + number})
    if isinstance(guess, PosesGuess):
        return RandomGuess(kind="random", seed=OWN + number, spread=_SPREAD, about=guess)
    duration = getattr(guess, "duration", None)
    return RandomGuess(kind="random", seed=OWN + number, duration=duration)


def _share(run: Run, left: int) -> Run:
    """The run with its deadline at this guess's share of the time that is left."""
    now = time.monotonic()
    return dataclasses.replace(run, deadline=now + max(run.deadline - now, 0.0) / left)


def _concluded(problem: Problem, found: list[tuple[int, Solution]], run: Run) -> Solution:
    seed, best = min(found, key=lambda pair: rank(pair[1]))
    motions = sum(solution.status in FOUND for _, solution in found)
    lines = [f"{motions} of {len(found)} guesses led to a motion."] if motions < len(found) else []
    if len(found) < problem.multistart:
        lines.append(f"{problem.multistart - len(found)} guesses were not tried: no time was left.")
    digest = {"spec_sha256": spec_sha256(problem), "seed": seed}
    return best.model_copy(
        update={
            "minima": distinct(found),
            "warnings": [*best.warnings, *lines],
            "timing": run.timing(),
            "reproduce": best.reproduce.model_copy(update=digest),
        }
    )
