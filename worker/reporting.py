"""What a running solve tells the store, and what the store tells it; both may be away for a while.

Nothing here may slow or end a solve: what cannot be sent at once is kept or dropped.
"""

import logging
import os
import time
from collections import deque

from schemas.errors import StoreUnavailable, UnknownJob
from schemas.events import EngineEvent, MeshSolved, NlpIteration, StageStarted
from schemas.jobs import JobStatus, JobTimings, Progress
from schemas.results import Solution
from store.ports import JobRecord, Store

logger = logging.getLogger("footfall.worker")

EVERY = 0.1
"""Seconds between two NLP iterations that are told, and between two glances at the flag."""

_AWAY = 1.0
"""Seconds of silence after the store was away."""

_KEPT = 200


class Reporter:
    """Turns engine events into the log and the record's progress.

    Stages and meshes are always told, if late; of the NLP iterations ten a second.
    """

    def __init__(self, store: Store, record: JobRecord) -> None:
        self._store = store
        self._record = record
        self._progress = Progress()
        self._seconds: dict[str, float] = {}
        self._stage_since = time.monotonic()
        self._pending: deque[EngineEvent] = deque(maxlen=_KEPT)
        self._next_iteration = 0.0
        self._next_update = 0.0
        self._quiet_until = 0.0
        self.stale = False

    def __call__(self, event: EngineEvent) -> None:
        """Take an event of the engine."""
        now = time.monotonic()
        self._progress = self._progress.model_copy(update=self._news(event, now))
        if isinstance(event, NlpIteration):
            if now < max(self._next_iteration, self._quiet_until):
                return
            self._next_iteration = now + EVERY
        self._pending.append(event)
        self.flush()

    def snapshot(self, solution: Solution) -> None:
        """Store what there is so far; dropped while the store is away."""
        record = self._record
        try:
            document = solution.model_dump_json().encode()
            self._store.results.snapshot(record.id, record.token, document)
        except StoreUnavailable:
            logger.warning("job %s: a snapshot was dropped, the store is away", record.id)

    def flush(self, *, last: bool = False) -> None:
        """Send what is pending, unless the store was away a moment ago.

        The record's progress follows ten times a second, and with the ``last`` flush.
        """
        now, record = time.monotonic(), self._record
        if now < self._quiet_until:
            return
        try:
            while self._pending:
                self._store.events.append(record.id, self._pending[0], record.token)
                self._pending.popleft()
            if last or now >= self._next_update:
                self._next_update = now + EVERY
                self.stale = not self._store.jobs.update(
                    record.id, record.token, self._progress, self.timings()
                )
        except StoreUnavailable:
            self._quiet_until = time.monotonic() + _AWAY

    def timings(self) -> JobTimings:
        """Seconds of each stage so far."""
        started = self._record.started or self._record.created
        seconds = dict(self._seconds)
        if self._progress.stage:
            stage, spent = self._progress.stage, time.monotonic() - self._stage_since
            seconds[stage] = seconds.get(stage, 0.0) + spent
        return JobTimings(queued=max(0.0, started - self._record.created), **seconds)

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
        return event.model_dump(include={"mesh", "iteration", "objective", "violation"})


class StopFlag:
    """Whether the engine should stop: cancelled, overtaken by another attempt, or an orphan."""

    def __init__(self, store: Store, record: JobRecord, reporter: Reporter) -> None:
        self._store = store
        self._record = record
        self._reporter = reporter
        self._parent = os.getppid()
        self._next = 0.0
        self._stop = False

    def __call__(self) -> bool:
        """Ask; the store is looked at ten times a second at most."""
        now = time.monotonic()
        if self._stop or now < self._next:
            return self._stop
        self._next = now + EVERY
        try:
            self._stop = self._asked()
        except StoreUnavailable:
            self._next = time.monotonic() + _AWAY
        return self._stop

    def _asked(self) -> bool:
        if self._reporter.stale or os.getppid() != self._parent:
            return True
        try:
            record = self._store.jobs.get(self._record.id)
        except UnknownJob:
            return True
        return record.status is not JobStatus.RUNNING or record.token != self._record.token
