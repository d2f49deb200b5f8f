"""One job, from its id to its end; runs in a process of its own, forked from the worker."""

import json
import logging
import time
from contextvars import ContextVar
from dataclasses import dataclass

from schemas.errors import StoreUnavailable
from schemas.jobs import JobKind, JobStatus
from schemas.reading import read_problem
from schemas.simulations import read_simulation
from store.ports import JobRecord, Store
from worker.attempt import Engines, attempt
from worker.chunk import solve_chunk
from worker.outcomes import Finished, Outcome
from worker.reporting import Reporter

logger = logging.getLogger("footfall.worker")


@dataclass(frozen=True, slots=True)
class Runner:
    """Runs jobs. ``glance`` is the same store without patience, for what may be dropped."""

    store: Store
    glance: Store
    engines: Engines
    worker: str

    def run(self, job_id: str) -> None:
        """Claim, work, store the result, move the state; nothing if the job is not to be had."""
        record = self.store.jobs.claim(job_id, self.worker)
        if record is None:
            logger.info("job %s is not queued any more; passed over", job_id)
            return
        logger.info("job %s: attempt %d starts", job_id, record.attempts)
        reporter = Reporter(self.glance, record)
        if record.kind is JobKind.SWEEP_CHUNK:
            self._chunk(record, reporter)
        else:
            self._whole(record, reporter)

    def _chunk(self, record: JobRecord, reporter: Reporter) -> None:
        """The points are stored as they end; what is left is the state of the job."""
        with reporter.talking():
            outcome = solve_chunk(self.store, self.engines.solve, record, reporter)
        reporter.finish(with_snapshot=False)
        if outcome is None:
            logger.warning("job %s was taken over by another attempt", record.id)
        else:
            self._move(record, outcome, reporter)

    def _whole(self, record: JobRecord, reporter: Reporter) -> None:
        """A job with one document and one result."""
        document = self.store.jobs.problem(record.id)
        work = self._simulate if record.kind is JobKind.SIMULATION else self._solve
        with reporter.talking():
            outcome = attempt(
                lambda deadline: work(document, reporter, deadline),
                reporter,
                seconds=record.seconds,
                megabytes=record.megabytes,
            )
        self._finish(record, document, outcome, reporter)

    def _solve(self, document: bytes, reporter: Reporter, deadline: float) -> Finished:
        return self.engines.solve(
            read_problem(document),
            on_event=reporter,
            deadline=deadline,
            should_stop=lambda: reporter.stop,
            on_snapshot=reporter.snapshot,
        )

    def _simulate(self, document: bytes, reporter: Reporter, deadline: float) -> Finished:
        return self.engines.simulate(
            read_simulation(document),
            on_event=reporter,
            deadline=deadline,
            should_stop=lambda: reporter.stop,
        )

    def _finish(
        self, record: JobRecord, document: bytes, outcome: Outcome[Finished], reporter: Reporter
    ) -> None:
        """The result first, then the state that promises it; what nobody waits for comes last."""
        finished = outcome.result
        reporter.finish(with_snapshot=finished is None)
        result = finished.model_dump_json().encode() if finished else None
        if result and not self.store.results.put(record.id, record.token, result):
            logger.warning("job %s was taken over by another attempt", record.id)
            return
        if self._move(record, outcome, reporter) and result:
            self._report(record, result, document)

    def _move(self, record: JobRecord, outcome: Outcome[Finished], reporter: Reporter) -> bool:
        """The state in which the attempt leaves its job; False if the attempt is stale."""
        finished, error = outcome.result, outcome.error
        moved = self.store.jobs.move(
            record.id,
            outcome.to,
            expect=frozenset({JobStatus.RUNNING, JobStatus.CANCELLING}),
            token=record.token,
            solution_status=finished.status if finished else None,
            message=finished.message if finished else error.message if error else "",
            error=error,
            timings=reporter.timings(),
        )
        if moved is None:
            logger.warning("job %s was taken over by another attempt", record.id)
            return False
        seconds = time.time() - (record.started or record.created)
        how = finished.status if finished else error.type if error else record.kind
        logger.info("job %s: %s (%s) after %.2f s", record.id, outcome.to, how, seconds)
        self._to_disk(record.id)
        return True

    def _report(self, record: JobRecord, result: bytes, document: bytes) -> None:
        try:
            page = self.engines.render(json.loads(result), json.loads(document)).encode()
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
