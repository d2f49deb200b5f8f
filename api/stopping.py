"""Cancelling: a queued job ends at once, a running one is asked first and killed a second later."""

import asyncio
import logging
from contextlib import suppress

from anyio import to_thread

from schemas.errors import Conflict, StoreUnavailable, UnknownJob
from schemas.jobs import TERMINAL, JobStatus
from store.ports import JobRecord, Store

logger = logging.getLogger("footfall.api")
_TRIES = 60


def cancel(store: Store, record: JobRecord) -> JobRecord:
    """Ask a live job to end; the record afterwards. An ended job stays as it is."""
    for _ in range(5):
        if record.status in TERMINAL or record.status is JobStatus.CANCELLING:
            return record
        _move(store, record)
        record = store.jobs.get(record.id, record.owner)
    raise Conflict("The job changes its state too fast to be cancelled.", "Try again.")


def _move(store: Store, record: JobRecord) -> None:
    """One attempt; the worker may be faster, so the caller looks again."""
    words = "Cancelled before it started."
    queued = frozenset({JobStatus.QUEUED})
    if store.jobs.move(record.id, JobStatus.CANCELLED, expect=queued, message=words):
        store.queue.remove(record.id)
    else:
        running = frozenset({JobStatus.RUNNING})
        store.jobs.move(record.id, JobStatus.CANCELLING, expect=running, message="Asked to stop.")


class Stopper:
    """Kills running jobs that were asked to stop and did not, one task a job.

    A kill is a message that can be lost, so it is repeated until the job has ended.
    """

    def __init__(self, store: Store, grace: float) -> None:
        self._store = store
        self._grace = grace
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def watch(self, job_id: str) -> None:
        """Kill this job after the grace, and again each second, until it has ended."""
        if job_id not in self._tasks:
            task = asyncio.create_task(self._insist(job_id))
            self._tasks[job_id] = task
            task.add_done_callback(lambda _: self._tasks.pop(job_id, None))

    async def close(self) -> None:
        """Give up on all of them."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _insist(self, job_id: str) -> None:
        for _ in range(_TRIES):
            await asyncio.sleep(self._grace)
            with suppress(StoreUnavailable):
                if await to_thread.run_sync(self._stop_unless_ended, job_id):
                    return
        logger.error("job %s does not stop, after %d kills", job_id, _TRIES)

    def _stop_unless_ended(self, job_id: str) -> bool:
        try:
            record = self._store.jobs.get(job_id)
        except UnknownJob:
            return True
        # A job whose worker died goes back to the queue or ends; only what still runs is killed.
        if record.status is not JobStatus.CANCELLING:
            return True
        self._store.queue.stop(job_id)
        return False
