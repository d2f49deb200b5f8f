"""A stored record as clients see it."""

import hashlib
from datetime import UTC, datetime

import orjson
from fastapi import Response

from schemas.jobs import TERMINAL, Job, JobKind, JobPage, JobStatus
from store.ports import JobRecord, Page, Store


def job_view(record: JobRecord, store: Store) -> Job:
    """The public view, with its place in the queue while it waits."""
    waits = record.status is JobStatus.QUEUED
    return _view(record, store.queue.position(record.id) if waits else None)


def page_view(page: Page, store: Store) -> JobPage:
    """A page of a listing; the queue is read once for all of it."""
    waits = any(record.status is JobStatus.QUEUED for record in page.records)
    waiting = store.queue.waiting() if waits else []
    places = {job_id: place for place, job_id in enumerate(waiting)}
    jobs = [_view(record, places.get(record.id)) for record in page.records]
    return JobPage(jobs=jobs, next=page.next)


def _view(record: JobRecord, place: int | None) -> Job:
    return Job(
        id=record.id,
        name=record.name,
        kind=record.kind,
        status=record.status,
        solution_status=record.solution_status,
        message=record.message,
        created=iso_time(record.created),
        started=None if record.started is None else iso_time(record.started),
        finished=None if record.finished is None else iso_time(record.finished),
        attempts=record.attempts,
        queue_position=place,
        progress=record.progress,
        timings=record.timings,
        error=record.error,
        links=_links(record),
    )


def job_response(
    job: Job, status: int = 200, headers: dict[str, str] | None = None, result: bytes | None = None
) -> Response:
    """The reply with a job; a result is put in as it was stored, without reading it."""
    document = job.model_dump(mode="json")
    document["result"] = orjson.Fragment(result) if result is not None else None
    content = orjson.dumps(document)
    tag = {"ETag": etag(content), "Cache-Control": "private, no-cache"}
    return Response(content, status, tag | (headers or {}), "application/json")


def etag(content: bytes) -> str:
    """A strong entity tag."""
    return f'"{hashlib.sha256(content).hexdigest()[:24]}"'


def matches(if_none_match: str | None, tag: str) -> bool:
    """Whether the client already has this."""
    known = [part.strip().removeprefix("W/") for part in (if_none_match or "").split(",")]
    return tag in known or "*" in known


def _links(record: JobRecord) -> dict[str, str]:
    base = f"/v1/jobs/{record.id}"
    links = {"self": base, "events": f"{base}/events"}
    if record.kind is JobKind.SWEEP_CHUNK:
        links["sweep"] = f"/v1/sweeps/{record.sweep}"
    elif record.status in TERMINAL:
        links |= {name: f"{base}/{name}" for name in ("result", "trajectory", "report.html")}
    if record.status not in TERMINAL:
        links["cancel"] = f"{base}/cancel"
    return links


def iso_time(seconds: float) -> str:
    """ISO 8601 in UTC, to the millisecond."""
    moment = datetime.fromtimestamp(seconds, UTC)
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")
