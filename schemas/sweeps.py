"""Sweeps: one problem at many places, as posted, as planned, and as clients see it.

A sweep is posted as a problem and either a ``grid`` (all combinations of some values), a list of
``points``, or a number of guesses (``multistart``). A point says what it puts in the place of
what: `schemas.patching.replaced` makes its problem, for the checks and for the worker.
"""

from enum import StrEnum
from typing import Any, Literal

from pydantic import Field

from schemas.base import Label, Posted, Strict
from schemas.jobs import JobError
from schemas.limits import MODEL_LIMITS

Values = dict[str, Any]
"""JSON pointers into the problem, each with the value that goes there."""

Kind = Literal["grid", "points", "multistart"]


class SweepRequest(Posted):
    """One problem over a grid, a list of points or a number of guesses."""

    problem: dict[str, Any] = Field(description="As for POST /v1/jobs.")
    grid: dict[str, list[Any]] | None = Field(
        default=None,
        description="JSON pointers into the problem with their values; the last varies fastest.",
        examples=[{"/phases/0/system/parameters/m1": [0.5, 1.0, 2.0]}],
    )
    points: list[Values] | None = Field(
        default=None, description="A point for each entry: JSON pointers with one value each."
    )
    multistart: int | None = Field(
        default=None,
        ge=2,
        le=MODEL_LIMITS.multistart,
        description="Guesses: the problem's own, then random ones with the seeds 1, 2, ...",
    )
    name: Label | None = Field(default=None, description="The problem's unless given.")
    chunk: int | None = Field(
        default=None,
        ge=1,
        le=MODEL_LIMITS.sweep,
        description="Points that one job solves in a row; 8 or fewer unless given, 1 for guesses.",
    )
    warm: bool | None = Field(
        default=None,
        description="Start each point from the solution of the one before it in its job. True "
        "unless given; guesses are independent of each other.",
    )


class SweepPlan(Strict):
    """A sweep as stored: ``base`` is self-contained, ``points`` say what each changes in it.

    ``seconds`` and ``megabytes`` are the most that one point may use.
    """

    name: str
    kind: Kind
    base: dict[str, Any]
    points: list[Values]
    axes: dict[str, list[Any]] | None = None
    chunk: int
    warm: bool
    seconds: float
    megabytes: int


class ChunkPlan(Strict):
    """What the job of a chunk has to do: the points from ``first`` up to ``end``."""

    sweep: str
    first: int
    end: int


class PointStatus(StrEnum):
    """Where a point is; as a job's status. ``expired``: it never ended, and its job is gone."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"
    EXPIRED = "expired"


class PointOutcome(Strict):
    """How a point has ended, as the worker stores it."""

    status: PointStatus
    solution_status: str | None = None
    objective: float | None = None
    verdict: str | None = None
    iterations: int = 0
    seconds: float = 0.0
    warm: bool = False
    message: str = ""
    error: JobError | None = None


class SweepPoint(Strict):
    """A point as clients see it; ``?fields=`` leaves out all but ``index`` and what it names."""

    index: int
    status: PointStatus | None = None
    values: Values | None = None
    solution_status: str | None = None
    objective: float | None = None
    verdict: str | None = None
    iterations: int | None = None
    seconds: float | None = None
    warm: bool | None = None
    message: str | None = None
    error: JobError | None = None
    links: dict[str, str] | None = None


class SweepMinimum(Strict):
    """One of the distinct minima that several guesses led to. ``points`` found it."""

    objective: float
    solution_status: str
    verdict: str
    points: list[int]
    links: dict[str, str]


class SweepStatus(StrEnum):
    """Where a sweep is. ``failed``: at least one point has failed; the others have results."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


ENDED = frozenset({SweepStatus.SUCCEEDED, SweepStatus.FAILED, SweepStatus.CANCELLED})


class Sweep(Strict):
    """The public view of a sweep. ``counts``: how many points are in each status.

    ``minima`` of a sweep over guesses: the distinct ones among the points that ended so far, the
    best first. Listings have no points.
    """

    id: str
    name: str
    kind: Kind
    status: SweepStatus
    created: str
    total: int
    counts: dict[PointStatus, int]
    axes: dict[str, list[Any]] | None = None
    chunk: int
    warm: bool
    points: list[SweepPoint] = Field(default_factory=list)
    minima: list[SweepMinimum] | None = None
    links: dict[str, str]


class SweepPage(Strict):
    """A page of sweeps, newest first. ``next`` is the cursor of the following page."""

    sweeps: list[Sweep]
    next: str | None = None
