"""Job records in a dictionary; a lock makes every move one step."""

import time
import uuid
from builtins import list as list_of
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

from schemas.errors import Conflict, UnknownJob
from schemas.events import StateChanged
from schemas.jobs import TERMINAL, JobError, JobKind, JobStatus, JobTimings, Progress
from store import cursors
from store.memory.shelf import Entry, Shelf
from store.moves import Changes, allowed, ending, is_asked, is_due
from store.ports import JobRecord, Page


class MemoryJobs:
    """Fills the port ``Jobs``."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf

    def create(self, record: JobRecord, problem: bytes) -> None:
        """Store a queued record and its problem."""
        with self._shelf.lock:
            self._shelf.entries[record.id] = Entry(record, problem)
            self._shelf.log(record.id, StateChanged(status=record.status, terminal=False))

    def get(self, job_id: str, owner: str | None = None) -> JobRecord:
        """The record; one whose result has had its time is moved to expired here."""
        with self._shelf.lock:
            entry = self._shelf.entry(job_id)
            if owner is not None and entry.record.owner != owner:
                raise UnknownJob(f"There is no job {job_id!r}.", "List yours with GET /v1/jobs.")
            if is_due(entry.record, self._shelf.settings.retention):
                status, message = frozenset({entry.record.status}), entry.record.message
                self.move(job_id, JobStatus.EXPIRED, expect=status, message=message)
                entry.result = entry.report = None
            return entry.record

    def many(self, job_ids: Sequence[str]) -> list_of[JobRecord | None]:
        """The records of several jobs at once."""
        with self._shelf.lock:
            known = self._shelf.entries
            return [self.get(job_id) if job_id in known else None for job_id in job_ids]

    def problem(self, job_id: str) -> bytes:
        """The stored problem."""
        with self._shelf.lock:
            return self._shelf.entry(job_id).problem

    def list(
        self,
        owner: str,
        *,
        status: JobStatus | None = None,
        name: str | None = None,
        kind: JobKind | None = None,
        cursor: str | None = None,
        limit: int = 50,
    ) -> Page:
        """An owner's jobs, newest first."""
        after = cursors.decode(cursor) if cursor else None
        with self._shelf.lock:
            records = [self.get(job_id) for job_id in list_of(self._shelf.entries)]
        found = [
            record
            for record in records
            if record.owner == owner
            and record.kind is not JobKind.SWEEP_CHUNK
            and is_asked(record, status, name, kind)
            and (after is None or (record.created, record.id) < after)
        ]
        found.sort(key=lambda record: (record.created, record.id), reverse=True)
        page = found[:limit]
        more = cursors.encode(page[-1].created, page[-1].id) if len(found) > limit else None
        return Page(page, more)

    def live(self) -> list_of[JobRecord]:
        """All jobs that have not ended."""
        with self._shelf.lock:
            records = [entry.record for entry in self._shelf.entries.values()]
        return [record for record in records if record.status not in TERMINAL]

    def claim(self, job_id: str, worker: str) -> JobRecord | None:
        """Queued -> running with a new token."""
        changes = Changes(token=uuid.uuid4().hex, worker=worker, started=time.time())
        queued = frozenset({JobStatus.QUEUED})
        return self._try(job_id, JobStatus.RUNNING, queued, None, changes, "attempts")

    def move(
        self,
        job_id: str,
        to: JobStatus,
        *,
        expect: frozenset[JobStatus],
        token: str | None = None,
        solution_status: str | None = None,
        message: str = "",
        error: JobError | None = None,
        timings: JobTimings | None = None,
        killed: bool = False,
    ) -> JobRecord | None:
        """Move by compare-and-set."""
        changes = Changes(
            finished=ending(to),
            token="" if to is JobStatus.QUEUED else None,
            solution_status=solution_status,
            message=message,
            error=error,
            timings=timings,
        )
        return self._try(job_id, to, expect, token, changes, "kills" if killed else "")

    def _try(
        self,
        job_id: str,
        to: JobStatus,
        expect: frozenset[JobStatus],
        token: str | None,
        changes: Changes,
        counter: str,
    ) -> JobRecord | None:
        sources = allowed(to, expect)
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None:
                return None
            record = entry.record
            if token and record.token == token and record.status is to:
                return record
            if record.status not in sources or (token and record.token != token):
                return None
            written: dict[str, Any] = {
                name: getattr(changes, name)
                for name in asdict(changes)
                if getattr(changes, name) is not None
            }
            if counter:
                written[counter] = getattr(record, counter) + 1
            entry.record = replace(record, status=to, **written)
            self._shelf.log(job_id, _event(entry.record))
            return entry.record

    def update(self, job_id: str, token: str, progress: Progress, timings: JobTimings) -> bool:
        """Progress of the live attempt."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None or entry.record.token != token:
                return False
            status = entry.record.status
            if status in (JobStatus.RUNNING, JobStatus.CANCELLING):
                entry.record = replace(entry.record, progress=progress, timings=timings)
            return status is JobStatus.RUNNING

    def delete(self, job_id: str, owner: str) -> None:
        """Forget an ended job."""
        with self._shelf.lock:
            record = self.get(job_id, owner)
            if record.status not in TERMINAL:
                raise Conflict(f"The job is {record.status}.", "Cancel it first.")
            del self._shelf.entries[job_id]
            self._shelf.wake(job_id)


def _event(record: JobRecord) -> StateChanged:
    return StateChanged(
        status=record.status,
        terminal=record.status in TERMINAL,
        attempt=record.attempts,
        message=record.message,
    )
