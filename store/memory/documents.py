"""Results, events and idempotency keys in memory."""

import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from schemas.errors import Conflict
from schemas.events import Event, StateChanged
from schemas.jobs import TERMINAL, JobStatus
from store.following import Log, clean_id, follow
from store.memory.shelf import Shelf
from store.ports import KEY_IN_FLIGHT, KEY_REUSED, LoggedEvent

_WORKED_ON = (JobStatus.RUNNING, JobStatus.CANCELLING)


class MemoryResults:
    """Fills the port ``Results``."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf

    def put(self, job_id: str, token: str, result: bytes) -> bool:
        """Store for the live attempt."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None or entry.record.token != token:
                return False
            if entry.record.status not in _WORKED_ON:
                return False
            entry.result = result
            entry.record = replace(entry.record, has_result=True)
            return True

    def put_report(self, job_id: str, token: str, report: bytes) -> bool:
        """Store beside the result."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None or entry.record.token != token or entry.result is None:
                return False
            if entry.record.status not in TERMINAL:
                return False
            entry.report = report
            return True

    def get(self, job_id: str) -> bytes | None:
        """The result's JSON, or None."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            return entry.result if entry else None

    def report(self, job_id: str) -> bytes | None:
        """The report's HTML, or None."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            return entry.report if entry else None


class MemoryEvents:
    """Fills the port ``Events``."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf

    def append(self, job_id: str, events: Sequence[Event], token: str) -> bool:
        """Add events."""
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None or entry.record.token != token:
                return False
            if entry.record.status not in _WORKED_ON:
                return False
            for event in events:
                self._shelf.log(job_id, event)
            return True

    def read(self, job_id: str, after: str = "0") -> list[LoggedEvent]:
        """The events after an id, at once."""
        first = int(clean_id(after).split("-")[0])
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            events = entry.events if entry else []
        return [logged for logged in events if int(logged.id.split("-")[0]) > first]

    def follow(
        self, job_id: str, after: str = "0", timeout: float = 15.0
    ) -> Iterator[LoggedEvent | None]:
        """Events as they come, up to the terminal one."""
        log = Log(
            read=lambda last_id: self.read(job_id, last_id),
            last=lambda: self._last(job_id),
            ended=lambda: self._ended(job_id),
        )
        with self._shelf.listening(job_id) as changed:
            yield from follow(log, changed, after, timeout)

    def _last(self, job_id: str) -> LoggedEvent | None:
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            if entry is None:
                return None
            said = StateChanged(status=entry.record.status, terminal=True)
            return entry.events[-1] if entry.events else LoggedEvent("0", said)

    def _ended(self, job_id: str) -> bool:
        with self._shelf.lock:
            entry = self._shelf.entries.get(job_id)
            return entry is None or entry.record.status in TERMINAL


@dataclass(slots=True)
class MemoryIdempotency:
    """Fills the port ``Idempotency``; a process is younger than a key."""

    _jobs: dict[tuple[str, str], tuple[str, str]] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def begin(self, owner: str, key: str, fingerprint: str) -> str | None:
        """Reserve a key."""
        with self._lock:
            if (owner, key) not in self._jobs:
                self._jobs[owner, key] = (fingerprint, "")
                return None
            return _judge(self._jobs[owner, key], fingerprint)

    def finish(self, owner: str, key: str, job_id: str) -> None:
        """The key has made this job."""
        with self._lock:
            fingerprint, _ = self._jobs[owner, key]
            self._jobs[owner, key] = (fingerprint, job_id)

    def abandon(self, owner: str, key: str) -> None:
        """The key is free again."""
        with self._lock:
            self._jobs.pop((owner, key), None)


def _judge(earlier: tuple[str, str], fingerprint: str) -> str:
    if earlier[0] != fingerprint:
        raise Conflict(KEY_REUSED, "Use a new key for a new request.")
    if not earlier[1]:
        raise Conflict(KEY_IN_FLIGHT, "Wait for the answer to the first request.")
    return earlier[1]
