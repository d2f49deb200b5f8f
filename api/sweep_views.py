"""A sweep as clients see it, put together from its points and its jobs as they are now."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import isclose

import orjson
from fastapi import Response

from api.views import iso_time
from schemas.jobs import TERMINAL, JobStatus
from schemas.results import SolutionStatus
from schemas.sweeps import (
    ENDED,
    PointOutcome,
    PointStatus,
    Sweep,
    SweepMinimum,
    SweepPlan,
    SweepPoint,
    SweepStatus,
)
from store.ports import JobRecord, Points, Store, SweepRecord

_SAME = 1e-6
"""Objectives so near to each other, relative to their size, are one minimum."""

_TINY = 1e-9
"""The same near to zero, where there is no size."""

_MINIMA = frozenset(
    {
        SolutionStatus.CONVERGED,
        SolutionStatus.ACCEPTABLE,
        SolutionStatus.MESH_LIMIT,
        SolutionStatus.CERTIFICATE_FAILED,
    }
)
"""Where the NLP was solved; anything else is no minimum."""

_OF_JOB = {
    JobStatus.QUEUED: PointStatus.QUEUED,
    JobStatus.FAILED: PointStatus.FAILED,
    JobStatus.CANCELLED: PointStatus.CANCELLED,
}


@dataclass(frozen=True, slots=True)
class State:
    """What is known of a sweep. The jobs are read first: a point may end, but never un-end."""

    record: SweepRecord
    plan: SweepPlan
    jobs: Sequence[JobRecord | None]
    points: Points

    @classmethod
    def read(cls, store: Store, record: SweepRecord) -> "State":
        """As the store has it now."""
        jobs = store.jobs.many(record.jobs)
        plan = SweepPlan.model_validate_json(store.sweeps.plan(record.id))
        return cls(record, plan, jobs, store.sweeps.points(record.id))

    def job(self, index: int) -> JobRecord | None:
        """The job of a point."""
        return self.jobs[index // self.record.chunk]

    def of_point(self, index: int) -> PointStatus:
        """Where a point is: as it ended, or as its job is."""
        if index in self.points.ended:
            return self.points.ended[index].status
        job = self.job(index)
        if job is None:
            return PointStatus.EXPIRED
        if job.status in (JobStatus.RUNNING, JobStatus.CANCELLING):
            return PointStatus.RUNNING if index in self.points.begun else PointStatus.QUEUED
        return _OF_JOB.get(job.status, PointStatus.EXPIRED)

    def counts(self) -> dict[PointStatus, int]:
        """How many points are in each status."""
        found = Counter(self.of_point(index) for index in range(self.record.total))
        return {status: found[status] for status in PointStatus}

    def status(self) -> SweepStatus:
        """Where the whole is."""
        counts = self.counts()
        if any(job and job.status not in TERMINAL for job in self.jobs):
            if self.record.cancelled is not None:
                return SweepStatus.CANCELLING
            waits = counts[PointStatus.QUEUED] == self.record.total
            return SweepStatus.QUEUED if waits else SweepStatus.RUNNING
        if counts[PointStatus.CANCELLED]:
            return SweepStatus.CANCELLED
        lost = counts[PointStatus.FAILED] + counts[PointStatus.EXPIRED]
        return SweepStatus.FAILED if lost else SweepStatus.SUCCEEDED


def sweep_view(state: State, *, whole: bool) -> Sweep:
    """The public view; ``whole``: with its points and minima."""
    record, plan, status = state.record, state.plan, state.status()
    base = f"/v1/sweeps/{record.id}"
    guesses = plan.kind == "multistart"
    return Sweep(
        id=record.id,
        name=record.name,
        kind=plan.kind,
        status=status,
        created=iso_time(record.created),
        total=record.total,
        counts=state.counts(),
        axes=plan.axes,
        chunk=record.chunk,
        warm=plan.warm,
        points=[_point(state, index) for index in range(record.total)] if whole else [],
        minima=_minima(state) if whole and guesses else None,
        links={"self": base} | ({} if status in ENDED else {"cancel": f"{base}/cancel"}),
    )


def sweep_response(
    state: State,
    status: int = 200,
    headers: dict[str, str] | None = None,
    fields: set[str] | None = None,
) -> Response:
    """The reply with a sweep; of its points only the ``fields``, if given, and none if empty."""
    document = sweep_view(state, whole=True).model_dump(mode="json")
    if fields is not None:
        document["points"] = [
            {name: value for name, value in point.items() if name in fields}
            for point in document["points"]
            if fields
        ]
    kept = {"Cache-Control": "private, no-cache"} | (headers or {})
    return Response(orjson.dumps(document), status, kept, "application/json")


def _point(state: State, index: int) -> SweepPoint:
    outcome = state.points.ended.get(index) or PointOutcome(status=state.of_point(index))
    job = state.job(index)
    error = outcome.error
    if index not in state.points.ended and outcome.status is PointStatus.FAILED and job:
        error = job.error
    return SweepPoint(
        index=index,
        values=state.plan.points[index],
        links=_links(state, index),
        **{**dict(outcome), "error": error},
    )


def _links(state: State, index: int) -> dict[str, str]:
    links = {"job": f"/v1/jobs/{state.record.jobs[index // state.record.chunk]}"}
    outcome = state.points.ended.get(index)
    if outcome and outcome.solution_status:
        links["result"] = f"/v1/sweeps/{state.record.id}/points/{index}/result"
    return links


def _minima(state: State) -> list[SweepMinimum]:
    """The distinct minima: of the same verdict and objective counts one. The best comes first."""
    found: list[tuple[float, PointOutcome, list[int]]] = []
    for index, outcome in sorted(state.points.ended.items()):
        value = outcome.objective
        if value is None or outcome.solution_status not in _MINIMA:
            continue
        same = next((at for at in found if _is_same(at[0], at[1], value, outcome)), None)
        if same:
            same[2].append(index)
        else:
            found.append((value, outcome, [index]))
    found.sort(key=lambda one: one[0])
    return [
        SweepMinimum(
            objective=value,
            solution_status=outcome.solution_status or "",
            verdict=outcome.verdict or "",
            points=points,
            links=_links(state, points[0]),
        )
        for value, outcome, points in found
    ]


def _is_same(value: float, first: PointOutcome, other: float, outcome: PointOutcome) -> bool:
    near = isclose(value, other, rel_tol=_SAME, abs_tol=_TINY)
    return near and first.verdict == outcome.verdict
