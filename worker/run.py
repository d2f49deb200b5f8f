"""One job, from its id to its end; runs in a process of its own, forked from the worker."""

import json
import logging
import time
from contextvars import ContextVar
from dataclasses import dataclass

from schemas.errors import StoreUnavailable
from schemas.jobs import JobKind, JobStatus
from schemas.reading import read_problem
from store.ports import JobRecord, Store
from worker.attempt import Engine, Render, attempt
from worker.chunk import solve_chunk
from worker.outcomes import Outcome
from worker.reporting import Reporter

logger = logging.getLogger("footfall.worker")


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
        reporter = Reporter(self.glance, record)
        if record.kind is JobKind.SWEEP_CHUNK:
            self._chunk(record, reporter)
        else:
            self._solve(record, reporter)

    def _chunk(self, record: JobRecord, reporter: Reporter) -> None:
        """The points are stored as they end; what is left is the state of the job."""
        with reporter.talking():
            outcome = solve_chunk(self.store, self.engine, record, reporter)
        reporter.finish(with_snapshot=False)
        if outcome is None:
            logger.warning("job %s was taken over by another attempt", record.id)
        else:
            self._move(record, outcome, reporter)

    def _solve(self, record: JobRecord, reporter: Reporter) -> None:
        problem = self.store.jobs.problem(record.id)
        with reporter.talking():
            outcome = attempt(
                self.engine,
                lambda: read_problem(problem),
                reporter,
                seconds=record.seconds,
                megabytes=record.megabytes,
                on_snapshot=reporter.snapshot,
            )
        self._finish(record, problem, outcome, reporter)

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
        if self._move(record, outcome, reporter) and result:
            self._report(record, result, problem)

    def _move(self, record: JobRecord, outcome: Outcome, reporter: Reporter) -> bool:
        """The state in which the attempt leaves its job; False if the attempt is stale."""
        solution, error = outcome.solution, outcome.error
        moved = self.store.jobs.move(
            record.id,
            outcome.to,
            expect=frozenset({JobStatus.RUNNING, JobStatus.CANCELLING}),
            token=record.token,
            solution_status=solution.status if solution else None,
            message=solution.message if solution else error.message if error else "",
            error=error,
            timings=reporter.timings(),
        )
        if moved is None:
            logger.warning("job %s was taken over by another attempt", record.id)
            return False
        seconds = time.time() - (record.started or record.created)
        how = solution.status if solution else error.type if error else record.kind
        logger.info("job %s: %s (%s) after %.2f s", record.id, outcome.to, how, seconds)
        self._to_disk(record.id)
        return True

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
