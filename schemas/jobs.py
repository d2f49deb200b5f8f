"""A job as clients see it, and the states it moves through.

queued -> running -> succeeded | failed
queued, running -> cancelling -> cancelled     (a queued job is cancelled at once)
running -> queued                              (its worker died; another attempt)
any ended state -> expired                     (the record outlives the result)
"""

from enum import StrEnum
from typing import Any

from pydantic import Field

from schemas.base import Strict


class JobStatus(StrEnum):
    """Where a job is. ``succeeded``: the engine finished; the solution says how."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"
    EXPIRED = "expired"


TERMINAL = frozenset(
    {JobStatus.SUCCEEDED, JobStatus.FAILED, JobStatus.CANCELLED, JobStatus.EXPIRED}
)

MOVES: dict[JobStatus, frozenset[JobStatus]] = {
    JobStatus.QUEUED: frozenset({JobStatus.RUNNING, JobStatus.CANCELLED, JobStatus.FAILED}),
    JobStatus.RUNNING: frozenset(
        {JobStatus.QUEUED, JobStatus.CANCELLING, JobStatus.SUCCEEDED, JobStatus.FAILED}
    ),
    JobStatus.CANCELLING: frozenset({JobStatus.CANCELLED, JobStatus.SUCCEEDED, JobStatus.FAILED}),
    JobStatus.SUCCEEDED: frozenset({JobStatus.EXPIRED}),
    JobStatus.FAILED: frozenset({JobStatus.EXPIRED}),
    JobStatus.CANCELLED: frozenset({JobStatus.EXPIRED}),
    JobStatus.EXPIRED: frozenset(),
}


class JobKind(StrEnum):
    """What a job does: solve one problem, simulate, or solve some points of a sweep in a row."""

    SOLVE = "solve"
    SIMULATION = "simulation"
    SWEEP_CHUNK = "sweep_chunk"


class JobIssue(Strict):
    """One thing wrong with the problem, as in a 422 reply."""

    pointer: str
    message: str
    hint: str = ""
    column: int | None = None


class JobError(Strict):
    """Why a job failed: a stable type, words, a hint, and for a model the places."""

    type: str
    message: str
    hint: str = ""
    issues: list[JobIssue] = Field(default_factory=list)


class Progress(Strict):
    """The latest that is known of a running solve; of a simulation ``time`` of ``end``, in s."""

    stage: str = ""
    mesh: int = 0
    segments: int = 0
    iteration: int = 0
    objective: float | None = None
    violation: float | None = None
    max_error: float | None = None
    time: float | None = None
    end: float | None = None


class JobTimings(Strict):
    """Seconds spent in each part of a job's life so far."""

    queued: float | None = None
    build: float | None = None
    solve: float | None = None
    refine: float | None = None
    certify: float | None = None
    simulate: float | None = None


class Job(Strict):
    """The public view of a job."""

    id: str
    name: str
    kind: JobKind = JobKind.SOLVE
    status: JobStatus
    solution_status: str | None = None
    message: str = ""
    created: str
    started: str | None = None
    finished: str | None = None
    attempts: int = 0
    queue_position: int | None = None
    progress: Progress | None = None
    timings: JobTimings
    error: JobError | None = None
    links: dict[str, str]
    result: dict[str, Any] | None = None


class JobPage(Strict):
    """A page of jobs, newest first. ``next`` is the cursor of the following page."""

    jobs: list[Job]
    next: str | None = None
