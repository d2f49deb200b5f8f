"""What the two stores share: the moves of a job, what moves and ends write, what is listed."""

import time
from dataclasses import dataclass

from schemas.events import PointEnded
from schemas.jobs import MOVES, TERMINAL, JobError, JobKind, JobStatus, JobTimings
from schemas.sweeps import PointOutcome
from store.ports import JobRecord


@dataclass(frozen=True, slots=True, kw_only=True)
class Changes:
    """What a move writes beside the state; None leaves a field as it is."""

    started: float | None = None
    finished: float | None = None
    token: str | None = None
    worker: str | None = None
    solution_status: str | None = None
    message: str | None = None
    timings: JobTimings | None = None
    error: JobError | None = None


def allowed(to: JobStatus, expect: frozenset[JobStatus]) -> frozenset[JobStatus]:
    """The expected states from which the move exists. ValueError if there is none."""
    sources = frozenset(state for state in expect if to in MOVES[state])
    if not sources:
        raise ValueError(f"no move leads from {sorted(expect)} to {to}")
    return sources


def ending(to: JobStatus) -> float | None:
    """When the job ended, if this move ends it; a job that expires has ended before."""
    return time.time() if to in TERMINAL and to is not JobStatus.EXPIRED else None


def is_due(record: JobRecord, retention: float) -> bool:
    """Whether the record's result has had its time, and the record does not say so yet."""
    ended = record.status in TERMINAL and record.status is not JobStatus.EXPIRED
    if not (ended and record.has_result and record.finished is not None):
        return False
    return record.finished + retention < time.time()


def is_asked(
    record: JobRecord, status: JobStatus | None, name: str | None, kind: JobKind | None
) -> bool:
    """Whether a listing with these filters has the record; None filters nothing."""
    return (
        status in (None, record.status)
        and name in (None, record.name)
        and kind in (None, record.kind)
    )


def point_event(index: int, outcome: PointOutcome) -> PointEnded:
    """What the log of its job says of a point that has ended."""
    return PointEnded(
        index=index,
        status=outcome.status,
        solution_status=outcome.solution_status,
        objective=outcome.objective,
        seconds=outcome.seconds,
    )
