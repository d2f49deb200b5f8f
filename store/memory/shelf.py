"""What the in-memory ports share: the entries, one lock, and the followers to wake."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from schemas.errors import UnknownJob
from schemas.events import Event
from schemas.sweeps import PointOutcome
from store.ports import JobRecord, LoggedEvent, SweepRecord
from store.settings import StoreSettings


@dataclass(slots=True)
class Entry:
    """All that is kept of one job."""

    record: JobRecord
    problem: bytes
    result: bytes | None = None
    report: bytes | None = None
    events: list[LoggedEvent] = field(default_factory=list)
    logged: int = 0


@dataclass(slots=True)
class SweepEntry:
    """All that is kept of one sweep; ``expires`` is when it is forgotten."""

    record: SweepRecord
    plan: bytes
    expires: float
    ended: dict[int, PointOutcome] = field(default_factory=dict)
    begun: dict[int, int] = field(default_factory=dict)
    results: dict[int, tuple[bytes, float]] = field(default_factory=dict)


@dataclass(slots=True)
class Shelf:
    """The entries by job id, and those of sweeps. Every access holds ``lock``."""

    settings: StoreSettings
    lock: threading.RLock = field(default_factory=threading.RLock)
    entries: dict[str, Entry] = field(default_factory=dict)
    sweeps: dict[str, SweepEntry] = field(default_factory=dict)
    waiting: list[tuple[str, threading.Event]] = field(default_factory=list)

    def entry(self, job_id: str) -> Entry:
        """The entry. Raises UnknownJob."""
        if job_id not in self.entries:
            raise UnknownJob(f"There is no job {job_id!r}.", "List yours with GET /v1/jobs.")
        return self.entries[job_id]

    def log(self, job_id: str, event: Event) -> None:
        """Append an event, wake the followers."""
        entry = self.entry(job_id)
        entry.logged += 1
        logged = LoggedEvent(f"{entry.logged}-0", event)
        entry.events = [*entry.events, logged][-self.settings.events_limit :]
        self.wake(job_id)

    def wake(self, job_id: str) -> None:
        """Wake those who follow this job."""
        for waits_for, changed in self.waiting:
            if waits_for == job_id:
                changed.set()

    @contextmanager
    def listening(self, job_id: str) -> Iterator[threading.Event]:
        """An event that is set whenever the job has something new."""
        follower = (job_id, threading.Event())
        with self.lock:
            self.waiting.append(follower)
        try:
            yield follower[1]
        finally:
            with self.lock:
                self.waiting.remove(follower)
