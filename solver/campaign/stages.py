"""Stages: problems solved in a row, each from the solution of the one before."""

import time
from dataclasses import dataclass, field

from schemas.events import StageStarted
from schemas.guesses import SolutionGuess, SolutionPhase
from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import Solution, SolutionStatus, StageReport
from schemas.stages import apply_stage, halfway
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
    row = _Row(problem, solve, run)
    for index in range(count):
        run.on_event(StageStarted(stage="build", note=f"stage {index + 1} of {count}"))
        row.reach(apply_stage(problem, index), problem.halvings)
        if not row.good or run.stopped():
            return _concluded(problem, row, index + 1)
    return _concluded(problem, row, count)


@dataclass(slots=True)
class _Row:
    """The stages so far: the last good one, the last solution, a report on each."""

    problem: Problem
    solve: SolveOnce
    run: Run
    before: tuple[Problem, Solution] | None = None
    last: Solution | None = None
    reports: list[StageReport] = field(default_factory=list)

    @property
    def good(self) -> bool:
        """Whether the last solve is one to go on from."""
        return self.last is not None and self.last.status in GOOD_START

    def reach(self, stage: Problem, halvings: int) -> None:
        """Solve a stage from the one before it; where that fails, by half of the way first."""
        if self._solved(stage) or self.before is None or halvings == 0 or self.run.stopped():
            return
        between = halfway(self.before[0], stage)
        if between is None:
            return
        self.run.on_event(StageStarted(stage="build", note="half of the way"))
        self.reach(between, halvings - 1)
        if self.good and not self.run.stopped():
            self.reach(stage, halvings - 1)

    def _solved(self, stage: Problem) -> bool:
        """Whether a stage, from the last good one, is one to go on from."""
        began = time.monotonic()
        start = stage
        if self.before is not None:
            start = stage.model_copy(update={"guess": solution_guess(self.before[1])})
        self.last = self.solve(start, self.run)
        self.reports.append(report(self.last, time.monotonic() - began))
        if self.good:
            self.before = (stage, self.last)
        return self.good


def solution_guess(solution: Solution) -> SolutionGuess:
    """What was found, as a guess: any method and any mesh can start from it."""
    return SolutionGuess(
        kind="solution",
        phases=[SolutionPhase(name=phase.name, curves=phase.curves) for phase in solution.phases],
        static={name: value for name, value in solution.static.items() if value is not None},
    )


def report(solution: Solution, seconds: float) -> StageReport:
    """What is told of a solve that was one of several."""
    meshes = solution.mesh_refinement.iterations
    return StageReport(
        status=solution.status,
        objective=solution.objective,
        nlp_iterations=sum(mesh.nlp_iterations for mesh in meshes),
        segments=meshes[-1].segments if meshes else 0,
        seconds=seconds,
    )


def _concluded(problem: Problem, row: _Row, done: int) -> Solution:
    """The last solution, with what became of all stages."""
    if (last := row.last) is None:
        raise ValueError("no stage was solved")
    count, message = len(problem.stages), last.message
    if done < count or not row.good:
        message = f"Stage {done} of {count}: {message}"
        if done < count:
            message += " The stages after it were not solved."
    digest = last.reproduce.model_copy(update={"spec_sha256": spec_sha256(problem)})
    changed = {"message": message, "stages": row.reports, "reproduce": digest}
    return last.model_copy(update=changed)
