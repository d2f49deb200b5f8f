"""Sweeps in memory."""

import time
from dataclasses import replace

from schemas.errors import UnknownSweep
from schemas.jobs import JobStatus
from schemas.sweeps import PointOutcome
from store import cursors
from store.memory.shelf import Shelf, SweepEntry
from store.moves import point_event
from store.ports import JobRecord, Points, SweepRecord, SweepRecords

_WORKED_ON = (JobStatus.RUNNING, JobStatus.CANCELLING)


class MemorySweeps:
    """Fills the port ``Sweeps``."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf

    def create(self, record: SweepRecord, plan: bytes) -> None:
        """Store a sweep and its plan."""
        with self._shelf.lock:
            self._shelf.sweeps[record.id] = SweepEntry(record, plan, self._memory())

    def get(self, sweep_id: str, owner: str | None = None) -> SweepRecord:
        """The record."""
        with self._shelf.lock:
            record = self._entry(sweep_id).record
            if owner is not None and record.owner != owner:
                raise _unknown(sweep_id)
            return record

    def plan(self, sweep_id: str) -> bytes:
        """The stored plan."""
        with self._shelf.lock:
            return self._entry(sweep_id).plan

    def list(self, owner: str, *, cursor: str | None = None, limit: int = 20) -> SweepRecords:
        """An owner's sweeps, newest first."""
        after = cursors.decode(cursor) if cursor else None
        now = time.time()
        with self._shelf.lock:
            own = [
                (entry.record.created, sweep_id)
                for sweep_id, entry in self._shelf.sweeps.items()
                if entry.record.owner == owner and entry.expires > now
            ]
            own.sort(reverse=True)
            rest = [key for key in own if after is None or key < after]
            records = [self._shelf.sweeps[sweep_id].record for _, sweep_id in rest[:limit]]
        more = cursors.encode(*rest[limit - 1]) if len(rest) > limit else None
        return SweepRecords(records, more)

    def points(self, sweep_id: str) -> Points:
        """What is known of the points."""
        with self._shelf.lock:
            entry = self._shelf.sweeps.get(sweep_id)
            return Points(dict(entry.ended), dict(entry.begun)) if entry else Points({}, {})

    def result(self, sweep_id: str, index: int) -> bytes | None:
        """The JSON of a point's result."""
        with self._shelf.lock:
            entry = self._shelf.sweeps.get(sweep_id)
            result, until = entry.results.get(index, (b"", 0.0)) if entry else (b"", 0.0)
        return result if until > time.time() else None

    def begin(self, sweep_id: str, index: int, job: JobRecord) -> int:
        """Note that the live attempt begins a point."""
        with self._shelf.lock:
            entry = self._live(sweep_id, job)
            if entry is None:
                return 0
            entry.begun[index] = entry.begun.get(index, 0) + 1
            return entry.begun[index]

    def end(
        self, sweep_id: str, index: int, job: JobRecord, outcome: PointOutcome, result: bytes | None
    ) -> bool:
        """Store how a point ended."""
        with self._shelf.lock:
            entry = self._live(sweep_id, job)
            if entry is None:
                return False
            if index in entry.ended:
                return True
            entry.ended[index] = outcome
            entry.expires = self._memory()
            if result is not None:
                entry.results[index] = (result, time.time() + self._shelf.settings.retention)
            self._shelf.log(job.id, point_event(index, outcome))
            return True

    def cancel(self, sweep_id: str) -> None:
        """Note that the sweep was asked to stop."""
        with self._shelf.lock:
            entry = self._entry(sweep_id)
            if entry.record.cancelled is None:
                entry.record = replace(entry.record, cancelled=time.time())

    def delete(self, sweep_id: str, owner: str) -> None:
        """Forget a sweep and its points."""
        with self._shelf.lock:
            self.get(sweep_id, owner)
            del self._shelf.sweeps[sweep_id]

    def _entry(self, sweep_id: str) -> SweepEntry:
        entry = self._shelf.sweeps.get(sweep_id)
        if entry is None or entry.expires <= time.time():
            raise _unknown(sweep_id)
        return entry

    def _live(self, sweep_id: str, job: JobRecord) -> SweepEntry | None:
        """The sweep, if the attempt is the live one of its job."""
        stored = self._shelf.entries.get(job.id)
        if stored is None or stored.record.token != job.token:
            return None
        return self._shelf.sweeps.get(sweep_id) if stored.record.status in _WORKED_ON else None

    def _memory(self) -> float:
        return time.time() + self._shelf.settings.memory


def _unknown(sweep_id: str) -> UnknownSweep:
    return UnknownSweep(f"There is no sweep {sweep_id!r}.", "List yours: GET /v1/sweeps.")
