"""The ports: what api and worker need of a store. ``store.backend`` and ``store.memory`` fill them.

All calls are synchronous (the api runs them in its thread pool). All raise ``StoreUnavailable``
when the server stays away. Every read for a client takes the owner: a foreign job is unknown.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Protocol

from schemas.events import Event
from schemas.jobs import JobError, JobKind, JobStatus, JobTimings, Progress
from schemas.sweeps import PointOutcome


@dataclass(frozen=True, slots=True)
class JobRecord:
    """A job as stored. Times are seconds since the epoch; ``token`` fences the live attempt.

    ``attempts`` counts claims, ``kills`` those whose process was killed under a living worker.
    ``has_result``: a result (or a snapshot of one) is stored. A chunk names its ``sweep`` and how
    many ``points`` it solves; ``seconds`` are for all of them together.
    """

    id: str
    owner: str
    name: str
    spec_sha256: str
    status: JobStatus
    created: float
    started: float | None = None
    finished: float | None = None
    attempts: int = 0
    token: str = ""
    worker: str = ""
    seconds: float = 600.0
    megabytes: int = 4096
    solution_status: str | None = None
    message: str = ""
    progress: Progress | None = None
    timings: JobTimings = field(default_factory=JobTimings)
    error: JobError | None = None
    kills: int = 0
    has_result: bool = False
    kind: JobKind = JobKind.SOLVE
    sweep: str = ""
    points: int = 1


@dataclass(frozen=True, slots=True)
class Page:
    """Records, newest first; ``next`` continues the listing, None ends it."""

    records: list[JobRecord]
    next: str | None


@dataclass(frozen=True, slots=True)
class SweepRecord:
    """A sweep as stored: never a job, but the parent of the chunks in ``jobs``.

    ``cancelled``: when it was asked to stop. Where its points are is in the points themselves and
    in the records of the jobs.
    """

    id: str
    owner: str
    name: str
    created: float
    total: int
    chunk: int
    jobs: tuple[str, ...]
    cancelled: float | None = None


@dataclass(frozen=True, slots=True)
class SweepRecords:
    """Records, newest first; ``next`` continues the listing, None ends it."""

    records: list[SweepRecord]
    next: str | None


@dataclass(frozen=True, slots=True)
class Points:
    """What is known of a sweep's points by index: how those that ended did, how often begun."""

    ended: dict[int, PointOutcome]
    begun: dict[int, int]


@dataclass(frozen=True, slots=True)
class LoggedEvent:
    """An event of one job; ``id`` grows and resumes a stream."""

    id: str
    event: Event


class Jobs(Protocol):
    """Job records. Moves are compare-and-set along ``schemas.jobs.MOVES``."""

    def create(self, record: JobRecord, problem: bytes) -> None:
        """Store a queued record and its document; a record is there before its id is queued."""

    def get(self, job_id: str, owner: str | None = None) -> JobRecord:
        """The record. ``owner`` None: the worker's view. Raises UnknownJob."""

    def many(self, job_ids: Sequence[str]) -> Sequence[JobRecord | None]:
        """The records of several jobs at once, None for unknown ones (the worker's view)."""

    def problem(self, job_id: str) -> bytes:
        """The stored problem, simulation, or plan of a chunk. Raises UnknownJob."""

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
        """An owner's jobs, newest first, without the chunks of sweeps.

        Raises BadProblem on a cursor that is not ours.
        """

    def live(self) -> Sequence[JobRecord]:
        """All jobs that have not ended, of every owner (the worker's view, for its sweep)."""

    def claim(self, job_id: str, worker: str) -> JobRecord | None:
        """Queued -> running with a new token and one more attempt; None if it is not queued."""

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
        """Move if the state is expected, the move allowed and the token (if given) the live one.

        Appends the state event in the same step. None if somebody else was first. A move back to
        queued takes the token away; ``killed`` counts one more kill.
        """

    def update(self, job_id: str, token: str, progress: Progress, timings: JobTimings) -> bool:
        """Progress of the live attempt; False if it should stop: cancelled, or live no more."""

    def delete(self, job_id: str, owner: str) -> None:
        """Forget an ended job, its problem, result, report and events.

        Raises UnknownJob, and Conflict while the job lives.
        """


class Sweeps(Protocol):
    """Sweeps and their points. A point ends once, whatever dies; a stale attempt writes nothing."""

    def create(self, record: SweepRecord, plan: bytes) -> None:
        """Store a sweep and its plan; its jobs follow."""

    def get(self, sweep_id: str, owner: str | None = None) -> SweepRecord:
        """The record. ``owner`` None: the worker's view. Raises UnknownSweep."""

    def plan(self, sweep_id: str) -> bytes:
        """The stored plan. Raises UnknownSweep."""

    def list(self, owner: str, *, cursor: str | None = None, limit: int = 20) -> SweepRecords:
        """An owner's sweeps, newest first. Raises BadProblem on a cursor that is not ours."""

    def points(self, sweep_id: str) -> Points:
        """What is known of the points."""

    def result(self, sweep_id: str, index: int) -> bytes | None:
        """The JSON of a point's result, or None."""

    def begin(self, sweep_id: str, index: int, job: JobRecord) -> int:
        """Note that the live attempt begins a point: how often it was begun; 0 if stale."""

    def end(
        self, sweep_id: str, index: int, job: JobRecord, outcome: PointOutcome, result: bytes | None
    ) -> bool:
        """Store how a point ended, with its event, in one step; False if stale.

        A point that has ended stays as it is.
        """

    def cancel(self, sweep_id: str) -> None:
        """Note that the sweep was asked to stop."""

    def delete(self, sweep_id: str, owner: str) -> None:
        """Forget a sweep and its points; its jobs are forgotten by themselves. UnknownSweep."""


class Results(Protocol):
    """Result documents and reports, compressed; kept for the store's retention time."""

    def put(self, job_id: str, token: str, result: bytes) -> bool:
        """Store for the live attempt, in the place of what it had so far; False if stale."""

    def put_report(self, job_id: str, token: str, report: bytes) -> bool:
        """Store beside the result of the attempt that ended the job, and for as long as it.

        False if the token is another one's, or the job is still live or forgotten.
        """

    def get(self, job_id: str) -> bytes | None:
        """The result's JSON, or None."""

    def report(self, job_id: str) -> bytes | None:
        """The report's HTML, or None."""


class Events(Protocol):
    """The log of one job's events, capped in length, the terminal one always kept."""

    def append(self, job_id: str, events: Sequence[Event], token: str) -> bool:
        """Add events of the live attempt in one step; False if it is not live any more."""

    def read(self, job_id: str, after: str = "0") -> list[LoggedEvent]:
        """The events after an id, at once."""

    def follow(
        self, job_id: str, after: str = "0", timeout: float = 15.0
    ) -> Iterator[LoggedEvent | None]:
        """Events as they come; None on each ``timeout`` of silence; ends after the terminal one.

        The terminal event comes even if ``after`` is it already. Streams of one process share one
        reader: an open stream holds no connection of its own.
        """


class Queue(Protocol):
    """The queue: ids only."""

    def enqueue(self, job_id: str) -> None:
        """Queue an id. Raises QueueFull."""

    def requeue(self, job_id: str) -> None:
        """Queue an id whose attempt was lost: next in line, and never too many."""

    def waiting(self) -> Sequence[str]:
        """The ids in the queue, the next one first."""

    def position(self, job_id: str) -> int | None:
        """0 is next; None if it does not wait."""

    def remove(self, job_id: str) -> None:
        """Take a waiting id out."""

    def stop(self, job_id: str) -> None:
        """Ask for the kill of a running job (repeat until its state is terminal)."""

    def length(self) -> int:
        """How many ids wait."""

    def workers(self) -> list[dict[str, object]]:
        """The live workers: name, pid, host, state, job, backends, versions."""

    def announce(self, worker: dict[str, object], ttl: float) -> None:
        """A worker lives (for ``ttl`` seconds more); ``worker`` is what ``workers`` shows."""

    def retire(self, worker: str) -> None:
        """A worker has ended."""


KEY_REUSED = "key-reused"
KEY_IN_FLIGHT = "key-in-flight"


class Idempotency(Protocol):
    """Keys of clients that must not create anything twice. Kept 24 hours, per owner."""

    def begin(self, owner: str, key: str, fingerprint: str) -> str | None:
        """Reserve a key: None if it is new, else the id of the job or sweep it made.

        Raises Conflict, its message ``KEY_REUSED`` when the key came with another body,
        ``KEY_IN_FLIGHT`` when the first request has not been answered yet.
        """

    def finish(self, owner: str, key: str, job_id: str) -> None:
        """The key has made this job or sweep."""

    def abandon(self, owner: str, key: str) -> None:
        """The request failed; the key is free again."""


@dataclass(frozen=True, slots=True)
class Store:
    """All ports of one server, wired in one place (``store.connect``, ``store.memory.connect``).

    ``durable`` returns once everything written so far is on disk (where the server can tell).
    ``ping`` raises StoreUnavailable when the server does not answer. ``uptime``: seconds since
    the server started. ``close`` ends the store's thread and connections; it is not used again.
    """

    jobs: Jobs
    sweeps: Sweeps
    results: Results
    events: Events
    queue: Queue
    idempotency: Idempotency
    durable: Callable[[], None]
    ping: Callable[[], None]
    uptime: Callable[[], float] = lambda: inf
    close: Callable[[], None] = lambda: None
