"""What a running solve tells the store, and what the store tells it.

The talking is done by a thread of its own, now and then: the engine never waits for the store,
whether that is slow or away. What cannot be sent is kept and told later.
"""

import logging
import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from schemas.errors import StoreUnavailable
from schemas.events import Advanced, EngineEvent, MeshSolved, NlpIteration, StageStarted
from schemas.jobs import JobTimings, Progress
from schemas.results import Solution
from store.ports import JobRecord, Store

logger = logging.getLogger("footfall.worker")

EVERY = 0.25
"""Seconds between two exchanges with the store; each costs the engine some milliseconds."""

PATIENCE = 0.5
"""Seconds between two snapshots; a solve that is over sooner leaves its result instead."""

_KEPT = 200
_STEPS = (NlpIteration, Advanced)


class Reporter:
    """Takes the engine's events and snapshots, and brings them to the store.

    Every stage and mesh is told, if late; of the steps (NLP iterations, advances of a simulation)
    between two exchanges the last.
    ``stop`` says whether the engine should: the job was cancelled, handed on, or is an orphan.
    """

    def __init__(self, store: Store, record: JobRecord) -> None:
        self.stop = False
        self._store = store
        self._record = record
        self._parent = os.getppid()
        self._lock = threading.Lock()  # over all that follows
        self._progress = Progress()
        self._seconds: dict[str, float] = {}
        self._stage_since = time.monotonic()
        self._events: list[EngineEvent] = []
        self._snapshot: Solution | None = None
        self._next_snapshot = time.monotonic() + PATIENCE

    @property
    def job_id(self) -> str:
        """Whose events these are."""
        return self._record.id

    # The engine's side: quick, and without the store.

    def __call__(self, event: EngineEvent) -> None:
        """Take an event of the engine."""
        with self._lock:
            news = self._news(event, time.monotonic())
            self._progress = self._progress.model_copy(update=news)
            if isinstance(event, _STEPS) and isinstance(self._last(), type(event)):
                self._events.pop()
            self._events.append(event)

    def snapshot(self, solution: Solution) -> None:
        """Take what there is so far."""
        with self._lock:
            self._snapshot = solution

    def timings(self) -> JobTimings:
        """Seconds of each stage so far."""
        started = self._record.started or self._record.created
        with self._lock:
            seconds = dict(self._seconds)
            if self._progress.stage:
                stage, spent = self._progress.stage, time.monotonic() - self._stage_since
                seconds[stage] = seconds.get(stage, 0.0) + spent
        return JobTimings(queued=max(0.0, started - self._record.created), **seconds)

    # The store's side.

    @contextmanager
    def talking(self) -> Iterator[None]:
        """Exchange with the store all the while."""
        ended = threading.Event()
        thread = threading.Thread(target=self._talk, args=(ended,), name="reporter", daemon=True)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()

    def exchange(self) -> None:
        """Send what is new, and ask whether to go on; while the store is away, later."""
        try:
            self._send_events()
            self.stop = not self._wanted() or self.stop
            if self.stop or time.monotonic() >= self._next_snapshot:
                self._send_snapshot()
        except StoreUnavailable:
            return

    def finish(self, *, with_snapshot: bool) -> None:
        """The last exchange; a snapshot is of no use where a result follows."""
        if not with_snapshot:
            self._snapshot = None
        self._next_snapshot = 0.0
        self.exchange()

    def _talk(self, ended: threading.Event) -> None:
        while not ended.wait(EVERY):
            try:
                self.exchange()
            except Exception:  # such as MemoryError: the solve is worth more than its progress
                logger.exception("job %s: progress could not be told", self._record.id)

    def _send_events(self) -> None:
        with self._lock:
            events, self._events = self._events, []
        if not events:
            return
        try:
            self._store.events.append(self._record.id, events, self._record.token)
        except StoreUnavailable:
            with self._lock:
                self._events = [*events, *self._events][-_KEPT:]
            raise

    def _send_snapshot(self) -> None:
        snapshot = self._snapshot
        if snapshot is None:
            return
        document = snapshot.model_dump_json().encode()
        self._store.results.put(self._record.id, self._record.token, document)
        self._next_snapshot = time.monotonic() + PATIENCE
        with self._lock:
            if self._snapshot is snapshot:
                self._snapshot = None

    def _wanted(self) -> bool:
        """Write the progress, and see whether this attempt should go on."""
        record, timings = self._record, self.timings()
        wanted = self._store.jobs.update(record.id, record.token, self._progress, timings)
        return wanted and os.getppid() == self._parent

    def _last(self) -> EngineEvent | None:
        return self._events[-1] if self._events else None

    def _news(self, event: EngineEvent, now: float) -> dict[str, object]:
        if isinstance(event, StageStarted):
            stage = self._progress.stage
            if stage:
                spent = now - self._stage_since
                self._seconds[stage] = self._seconds.get(stage, 0.0) + spent
            self._stage_since = now
            return {"stage": event.stage}
        if isinstance(event, MeshSolved):
            names = {"mesh", "segments", "objective", "max_error"}
            return event.model_dump(include=names)
        if isinstance(event, Advanced):
            return event.model_dump(include={"time", "end"})
        return event.model_dump(include={"mesh", "iteration", "objective", "violation"})
