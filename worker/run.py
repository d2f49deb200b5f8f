"""One job, from its id to its end; runs in a process of its own, forked from the worker."""

import json
import logging
import time
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, Protocol

from schemas.errors import StoreUnavailable
from schemas.events import EngineEvent
from schemas.jobs import JobStatus
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution
from store.ports import JobRecord, Store
from worker import limits, outcomes
from worker.outcomes import Outcome
from worker.reporting import Reporter

logger = logging.getLogger("footfall.worker")


class Engine(Protocol):
    """``solver.solve``, or what a test puts in its place."""

    def __call__(
        self,
        problem: Problem,
        *,
        on_event: Callable[[EngineEvent], None],
        deadline: float | None,
        should_stop: Callable[[], bool],
        on_snapshot: Callable[[Solution], None],
    ) -> Solution:
        """Solve. ``deadline`` is a time of ``time.monotonic``."""


Render = Callable[[dict[str, Any], dict[str, Any]], str]
"""``footfall.report.render``: a result and its problem to a page."""


@dataclass(frozen=True, slots=True)
class Runner:
    """Runs jobs. ``glance`` is the same store without patience, for what may be dropped."""

    store: Store
    glance: Store
    engine: Engine
    render: Render
    worker: str

    def run(self, job_id: str) -> None:
        """Claim, solve, store the result, move the state; nothing if the job is not to be had."""
        record = self.store.jobs.claim(job_id, self.worker)
        if record is None:
            logger.info("job %s is not queued any more; passed over", job_id)
            return
        logger.info("job %s: attempt %d starts", job_id, record.attempts)
        problem = self.store.jobs.problem(job_id)
        reporter = Reporter(self.glance, record)
        outcome = self._attempt(record, problem, reporter)
        self._finish(record, problem, outcome, reporter)

    def _attempt(self, record: JobRecord, problem: bytes, reporter: Reporter) -> Outcome:
        deadline = time.monotonic() + record.seconds
        try:
            with reporter.talking(), limits.memory(record.megabytes):
                solution = self.engine(
                    read_problem(problem),
                    on_event=reporter,
                    deadline=deadline,
                    should_stop=lambda: reporter.stop,
                    on_snapshot=reporter.snapshot,
                )
        except Exception as error:  # noqa: BLE001 - whatever the engine does, the job must end
            return outcomes.failed(error, record.id)
        return outcomes.solved(solution)

    def _finish(
        self, record: JobRecord, problem: bytes, outcome: Outcome, reporter: Reporter
    ) -> None:
        """The result first, then the state that promises it; what nobody waits for comes last."""
        solution = outcome.solution
        reporter.finish(with_snapshot=solution is None)
        result = solution.model_dump_json().encode() if solution else None
        if result and not self.store.results.put(record.id, record.token, result):
            logger.warning("job %s was taken over by another attempt", record.id)
            return
        moved = self.store.jobs.move(
            record.id,
            outcome.to,
            expect=frozenset({JobStatus.RUNNING, JobStatus.CANCELLING}),
            token=record.token,
            solution_status=solution.status if solution else None,
            message=solution.message
            if solution
            else outcome.error.message
            if outcome.error
            else "",
            error=outcome.error,
            timings=reporter.timings(),
        )
        if moved is None:
            logger.warning("job %s was taken over by another attempt", record.id)
            return
        seconds = time.time() - (record.started or record.created)
        how = solution.status if solution else outcome.error.type if outcome.error else ""
        logger.info("job %s: %s (%s) after %.2f s", record.id, outcome.to, how, seconds)
        self._to_disk(record.id)
        if result:
            self._report(record, result, problem)

    def _report(self, record: JobRecord, result: bytes, problem: bytes) -> None:
        try:
            page = self.render(json.loads(result), json.loads(problem)).encode()
            self.store.results.put_report(record.id, record.token, page)
        except Exception:  # the page is an extra; the job has ended well without it
            logger.exception("job %s: the report could not be made", record.id)

    def _to_disk(self, job_id: str) -> None:
        try:
            self.store.durable()
        except StoreUnavailable as error:
            logger.warning("job %s: its end may not be on disk yet: %s", job_id, error)


RUNNER: ContextVar[Runner] = ContextVar("RUNNER")
"""The worker's runner; a forked process inherits it."""


def perform(job_id: str) -> None:
    """What RQ calls, by name (``store.backend.queue.TASK``)."""
    RUNNER.get().run(job_id)
