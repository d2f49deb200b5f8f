"""Jobs whose attempt was lost: handed on, ended or given up, each by one compare-and-set."""

import logging
import time
from dataclasses import dataclass, field

from schemas.jobs import JobError, JobStatus
from schemas.results import SolutionStatus
from store.ports import JobRecord, Store
from worker import outcomes
from worker.settings import WorkerSettings

logger = logging.getLogger("footfall.worker")

WORKED_ON = frozenset({JobStatus.RUNNING, JobStatus.CANCELLING})
_OVERRUN = 30.0
"""Seconds over its budget after which a killed job counts as out of time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loss:
    """How an attempt was lost. ``blameless``: the worker was told to end, the job did nothing."""

    how: str
    killed: bool = False
    blameless: bool = False


def settle(store: Store, record: JobRecord, loss: Loss, settings: WorkerSettings) -> None:
    """Decide on a job whose attempt was lost. Whoever is second does nothing."""
    if record.status is JobStatus.CANCELLING:
        _cancelled(store, record)
        return
    error = _verdict(record, loss, settings)
    if error is not None:
        logger.error("job %s is given up: %s", record.id, error.message)
        store.jobs.move(
            record.id,
            JobStatus.FAILED,
            expect=WORKED_ON,
            token=record.token,
            error=error,
            message=error.message,
            killed=loss.killed,
        )
        return
    back = store.jobs.move(
        record.id,
        JobStatus.QUEUED,
        expect=frozenset({JobStatus.RUNNING}),
        token=record.token,
        message=f"Attempt {record.attempts} was lost: {loss.how}.",
        killed=loss.killed,
    )
    if back is not None:
        logger.warning("job %s goes back to the queue: %s", record.id, loss.how)
        store.queue.requeue(record.id)


def _cancelled(store: Store, record: JobRecord) -> None:
    store.jobs.move(
        record.id,
        JobStatus.CANCELLED,
        expect=frozenset({JobStatus.CANCELLING}),
        token=record.token,
        solution_status=SolutionStatus.CANCELLED if record.has_result else None,
        message="Stopped by force; the last snapshot is kept, if there was one.",
    )
    logger.info("job %s was cancelled by force", record.id)


def _verdict(record: JobRecord, loss: Loss, settings: WorkerSettings) -> JobError | None:
    """The error to give the job up with; None: it may try again."""
    if loss.blameless:
        return None
    if loss.killed and time.time() - (record.started or 0.0) > record.seconds + _OVERRUN:
        return outcomes.out_of_time()
    kills, share = record.kills + loss.killed, record.points  # each point may cost as many
    if kills >= settings.most_kills * share or record.attempts >= settings.most_attempts * share:
        return outcomes.worker_killed(record.attempts, loss.how)
    return None


@dataclass(slots=True)
class Sweep:
    """Looks for jobs that nobody works on.

    A worker counts as dead when its key has expired. After an outage all keys have, so the dead
    are not looked for until the server has been there for twice the time to live, and nor after
    this sweep was itself held up for longer than that time.
    """

    store: Store
    settings: WorkerSettings
    _steady_since: float = 0.0
    _last: float | None = None
    _missing: dict[str, float] = field(default_factory=dict)

    def due(self) -> bool:
        """Whether it is time for the next sweep."""
        return self._last is None or time.monotonic() - self._last >= self.settings.maintenance

    def run(self) -> None:
        """One sweep. Sweeps of several workers may overlap; every move is decided once."""
        now, ttl = time.monotonic(), self.settings.ttl
        if self._last is not None and now - self._last > self.settings.maintenance + ttl:
            self._steady_since = now
        self._last = now
        steady = min(now - self._steady_since, self.store.uptime()) > 2 * ttl
        records = self.store.jobs.live()
        if steady:
            self._reap([record for record in records if record.status in WORKED_ON])
        self._find_lost([record for record in records if record.status is JobStatus.QUEUED], now)

    def _reap(self, records: list[JobRecord]) -> None:
        if not records:
            return
        alive = {str(worker["name"]) for worker in self.store.queue.workers()}
        for record in records:
            if record.worker not in alive:
                settle(self.store, record, Loss(how="its worker died"), self.settings)

    def _find_lost(self, records: list[JobRecord], now: float) -> None:
        """Queue again what is queued but in no list for a whole time to live."""
        waiting = set(self.store.queue.waiting()) if records else set()
        lost = [record.id for record in records if record.id not in waiting]
        self._missing = {job_id: self._missing.get(job_id, now) for job_id in lost}
        for job_id, since in list(self._missing.items()):
            if now - since >= self.settings.ttl:
                logger.warning("job %s was queued but in no list; it is queued again", job_id)
                self.store.queue.requeue(job_id)
                del self._missing[job_id]
