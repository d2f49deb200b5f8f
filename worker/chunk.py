"""The points of a sweep that one job solves, one after another.

Each point is stored as it ends, so that a lost attempt loses no more than the point it was at:
the next attempt goes on from there. What goes wrong with one point is that point's own business.
"""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Never

import orjson
from pydantic import ValidationError

from schemas.errors import PROBLEM_TYPES, UnknownSweep
from schemas.guesses import SolutionGuess
from schemas.inlining import solution_guess
from schemas.jobs import JobError, JobStatus
from schemas.patching import replaced
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from schemas.sweeps import ChunkPlan, PointOutcome, PointStatus, SweepPlan
from store.ports import JobRecord, Points, Store
from worker import outcomes
from worker.attempt import Engine, attempt
from worker.outcomes import Outcome
from worker.reporting import Reporter

logger = logging.getLogger("footfall.worker")

_MOST_BEGINNINGS = 3
"""A point that so many attempts were lost at is given up: it may be what ends them."""

_SOLVED = frozenset({SolutionStatus.CONVERGED, SolutionStatus.ACCEPTABLE})
_FINAL = frozenset({SolutionStatus.CANCELLED, SolutionStatus.TIME_LIMIT})
"""After these there is no second try from the point's own guess."""


def solve_chunk(
    store: Store, engine: Engine, record: JobRecord, reporter: Reporter
) -> Outcome[Never] | None:
    """Solve what is left of a chunk; how its job ends, or None if it was taken over."""
    try:
        plan = SweepPlan.model_validate_json(store.sweeps.plan(record.sweep))
    except UnknownSweep as error:
        code = PROBLEM_TYPES[UnknownSweep].code
        return Outcome(JobStatus.FAILED, error=JobError(type=code, message=error.message))
    chunk = ChunkPlan.model_validate_json(store.jobs.problem(record.id))
    return _Chunk(store, engine, record, reporter, plan).run(chunk)


@dataclass(frozen=True, slots=True)
class _Tried:
    """How a point went; ``warm``: from the solution of another one."""

    outcome: Outcome[Solution]
    warm: bool = False
    seconds: float = 0.0


@dataclass(slots=True)
class _Chunk:
    """``guess`` is made of the last point that was solved; None before there is one."""

    store: Store
    engine: Engine
    record: JobRecord
    reporter: Reporter
    plan: SweepPlan
    guess: SolutionGuess | None = None

    def run(self, chunk: ChunkPlan) -> Outcome[Never] | None:
        known = self.store.sweeps.points(self.record.sweep)
        self._resume(chunk, known)
        for index in range(chunk.first, chunk.end):
            if index in known.ended:
                continue
            if self.reporter.stop:
                return Outcome(JobStatus.CANCELLED)
            begun = self.store.sweeps.begin(self.record.sweep, index, self.record)
            if begun == 0:
                return None
            tried = _given_up(begun - 1) if begun > _MOST_BEGINNINGS else self._solve(index)
            stopped = tried.outcome.to is JobStatus.CANCELLED
            if stopped and not self._cancelled():  # the attempt is an orphan; another one goes on
                return None
            if not self._keep(index, tried):
                return None
            if stopped:
                return Outcome(JobStatus.CANCELLED)
        return Outcome(JobStatus.SUCCEEDED)

    def _resume(self, chunk: ChunkPlan, known: Points) -> None:
        """Take up the last solution of a lost attempt."""
        solved = [
            index
            for index in range(chunk.first, chunk.end)
            if index in known.ended and known.ended[index].solution_status in _SOLVED
        ]
        result = self.store.sweeps.result(self.record.sweep, solved[-1]) if solved else None
        if self.plan.warm and result is not None:
            self.guess = _guess(orjson.loads(result))

    def _solve(self, index: int) -> _Tried:
        """From the solution before, and where that leads nowhere from the point's own guess."""
        began, guess = time.monotonic(), self.guess
        outcome = self._attempt(index, guess, self.plan.seconds)
        status = outcome.result.status if outcome.result else None
        if guess is not None and status not in _SOLVED | _FINAL:
            guess = None
            left = self.plan.seconds - (time.monotonic() - began)
            outcome = self._attempt(index, guess, left)
        if self.plan.warm and outcome.result and outcome.result.status in _SOLVED:
            self.guess = _guess(outcome.result.model_dump(mode="json"))
        return _Tried(outcome, guess is not None, time.monotonic() - began)

    def _attempt(
        self, index: int, guess: SolutionGuess | None, seconds: float
    ) -> Outcome[Solution]:
        began = time.monotonic()

        def work(deadline: float) -> Solution:
            point = read_problem(replaced(self.plan.base, self.plan.points[index]))
            return self.engine(
                _from(guess, point),
                on_event=self.reporter,
                deadline=min(deadline, began + point.limits.seconds),
                should_stop=lambda: self.reporter.stop,
                on_snapshot=lambda _: None,
            )

        return attempt(work, self.reporter, seconds=seconds, megabytes=self.plan.megabytes)

    def _cancelled(self) -> bool:
        return self.store.jobs.get(self.record.id).status is JobStatus.CANCELLING

    def _keep(self, index: int, tried: _Tried) -> bool:
        solution = tried.outcome.result
        result = solution.model_dump_json().encode() if solution else None
        outcome = _described(tried)
        logger.info("job %s: point %d %s", self.record.id, index, outcome.status)
        return self.store.sweeps.end(self.record.sweep, index, self.record, outcome, result)


def _guess(result: Mapping[str, Any]) -> SolutionGuess | None:
    """A guess made of a result, if one can be made."""
    try:
        return SolutionGuess.model_validate(solution_guess(result))
    except ValidationError:  # a warm start is an extra; the point has a guess of its own
        logger.warning("a result makes no guess for the next point")
        return None


def _from(guess: SolutionGuess | None, problem: Problem) -> Problem:
    """The problem with this guess instead of all of its own."""
    if guess is None:
        return problem
    phases = [phase.model_copy(update={"guess": None}) for phase in problem.phases]
    return problem.model_copy(update={"guess": guess, "phases": phases})


def _given_up(attempts: int) -> _Tried:
    error = outcomes.worker_killed(attempts, "its process or its worker ended each time")
    return _Tried(Outcome(JobStatus.FAILED, error=error))


def _described(tried: _Tried) -> PointOutcome:
    solution, error = tried.outcome.result, tried.outcome.error
    if solution is None:
        message = error.message if error else ""
        return PointOutcome(
            status=PointStatus(tried.outcome.to),
            seconds=tried.seconds,
            message=message,
            error=error,
        )
    return PointOutcome(
        status=PointStatus(tried.outcome.to),
        solution_status=solution.status,
        objective=solution.objective,
        verdict=solution.certificate.verdict,
        iterations=sum(mesh.nlp_iterations for mesh in solution.mesh_refinement.iterations),
        seconds=tried.seconds,
        warm=tried.warm,
        message=solution.message,
    )
