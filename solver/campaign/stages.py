"""Stages: problems solved in a row, each from the solution of the one before."""

import time
from collections.abc import Sequence

from schemas.events import StageStarted
from schemas.guesses import SolutionGuess, SolutionPhase
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import Solution, SolutionStatus, StageReport
from schemas.stages import apply_stage
from solver.campaign.once import SolveOnce
from solver.run import Run

GOOD_START = frozenset(
    {
        SolutionStatus.CONVERGED,
        SolutionStatus.ACCEPTABLE,
        SolutionStatus.CERTIFICATE_FAILED,
        SolutionStatus.MESH_LIMIT,
    }
)
"""From these the next stage starts: a coarse mesh need not be accurate to be a good guess."""


def solve_stages(problem: Problem, solve: SolveOnce, run: Run) -> Solution:
    """Solve the stages of a problem one after the other; without stages, the problem.

    Returns
    -------
    The last stage's solution with a report on each. A stage that fails ends the row: its status
    and its iterate are the result, and the message says which one it was.
    """
    count = len(problem.stages)
    if not count:
        return solve(problem, run)
    reports: list[StageReport] = []
    solutions: list[Solution] = []
    for index in range(count):
        run.on_event(StageStarted(stage="build", note=f"stage {index + 1} of {count}"))
        began = time.monotonic()
        solutions.append(solve(_stage(problem, index, solutions), run))
        reports.append(_report(solutions[-1], time.monotonic() - began))
        if solutions[-1].status not in GOOD_START or run.stopped():
            break
    return _concluded(problem, solutions[-1], reports)


def _stage(problem: Problem, index: int, before: Sequence[Solution]) -> Problem:
    stage = apply_stage(problem, index)
    return stage.model_copy(update={"guess": solution_guess(before[-1])}) if before else stage


def solution_guess(solution: Solution) -> SolutionGuess:
    """What was found, as a guess: any method and any mesh can start from it."""
    return SolutionGuess(
        kind="solution",
        phases=[SolutionPhase(name=phase.name, curves=phase.curves) for phase in solution.phases],
        static={name: value for name, value in solution.static.items() if value is not None},
    )


def _report(solution: Solution, seconds: float) -> StageReport:
    meshes = solution.mesh_refinement.iterations
    return StageReport(
        status=solution.status,
        objective=solution.objective,
        nlp_iterations=sum(mesh.nlp_iterations for mesh in meshes),
        segments=meshes[-1].segments if meshes else 0,
        seconds=seconds,
    )


def _concluded(problem: Problem, last: Solution, reports: list[StageReport]) -> Solution:
    done, count = len(reports), len(problem.stages)
    message = last.message
    if done < count or last.status not in GOOD_START:
        message = f"Stage {done} of {count}: {message}"
        if done < count:
            message += " The stages after it were not solved."
    digest = last.reproduce.model_copy(update={"spec_sha256": spec_sha256(problem)})
    return last.model_copy(update={"message": message, "stages": reports, "reproduce": digest})
