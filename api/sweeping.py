"""From a posted sweep to its queued jobs, and their end."""

import hashlib
import time
import uuid
from itertools import count

from pydantic import BaseModel

from api.context import Context
from api.earlier import sources
from api.once import Made, once
from api.planning import plan
from api.stopping import cancel
from api.submission import check_share
from schemas.errors import QueueFull
from schemas.inlining import inlined
from schemas.jobs import TERMINAL, JobKind, JobStatus
from schemas.sweeps import ChunkPlan, Kind, SweepPlan
from store.ports import JobRecord, Store, SweepRecord


class SweepValidation(BaseModel):
    """What ``?validate_only=true`` answers for a good sweep."""

    valid: bool = True
    name: str
    kind: Kind
    total: int
    jobs: int
    chunk: int
    warm: bool


def read(ctx: Context, body: bytes, owner: str) -> SweepPlan:
    """Check a posted sweep with all of its points. Raises BadProblem."""
    found = sources(ctx.store, owner)
    return plan(body, lambda document: inlined(document, found), ctx.settings)


def validation(plan: SweepPlan) -> SweepValidation:
    """The answer when nothing is to be stored."""
    return SweepValidation(
        name=plan.name,
        kind=plan.kind,
        total=len(plan.points),
        jobs=len(_chunks(plan)),
        chunk=plan.chunk,
        warm=plan.warm,
    )


def submit(
    ctx: Context, plan: SweepPlan, body: bytes, owner: str, key: str | None
) -> tuple[SweepRecord, bool]:
    """Store a sweep and queue its jobs; returns once all is on disk. True: the key's own sweep.

    Raises Conflict or KeyReused (see ``once``), QueueFull, RateLimited, StoreUnavailable.
    """

    def make(made: Made) -> SweepRecord:
        check_share(ctx, owner, len(_chunks(plan)))
        record, jobs = _create(ctx.store, plan, owner)
        made(record.id)
        _enqueue(ctx.store, record, jobs)
        for _ in jobs:
            ctx.metrics.accepted()
        return record

    def find(sweep_id: str) -> SweepRecord:
        return ctx.store.sweeps.get(sweep_id, owner)

    fingerprint = hashlib.sha256(b"sweep\n" + body).hexdigest()
    return once(ctx.store, (owner, key), fingerprint, make, find)


def stop(store: Store, record: SweepRecord) -> list[JobRecord]:
    """Ask all jobs of a sweep to end; those that still run."""
    store.sweeps.cancel(record.id)
    live = (job for job in store.jobs.many(record.jobs) if job and job.status not in TERMINAL)
    asked = [cancel(store, job) for job in live]
    return [job for job in asked if job.status is JobStatus.CANCELLING]


def forget(store: Store, record: SweepRecord) -> None:
    """Forget an ended sweep, its jobs and its results."""
    store.sweeps.delete(record.id, record.owner)
    for job in store.jobs.many(record.jobs):
        if job is not None:
            store.jobs.delete(job.id, job.owner)


def _chunks(plan: SweepPlan) -> list[range]:
    total = len(plan.points)
    firsts = range(0, total, plan.chunk)
    return [range(first, min(first + plan.chunk, total)) for first in firsts]


def _create(store: Store, plan: SweepPlan, owner: str) -> tuple[SweepRecord, list[JobRecord]]:
    """The sweep comes first: whoever finds a job of it finds the sweep."""
    now, chunks = time.time(), _chunks(plan)
    document = plan.model_dump_json().encode()
    record = SweepRecord(
        id=uuid.uuid4().hex,
        owner=owner,
        name=plan.name,
        created=now,
        total=len(plan.points),
        chunk=plan.chunk,
        jobs=tuple(uuid.uuid4().hex for _ in chunks),
    )
    digest = hashlib.sha256(document).hexdigest()
    store.sweeps.create(record, document)
    jobs = []
    for job_id, points, number in zip(record.jobs, chunks, count(1), strict=False):
        job = JobRecord(
            id=job_id,
            owner=owner,
            name=f"{plan.name[:180]} ({number}/{len(chunks)})",
            spec_sha256=digest,
            status=JobStatus.QUEUED,
            created=now,
            seconds=plan.seconds * len(points),
            megabytes=plan.megabytes,
            kind=JobKind.SWEEP_CHUNK,
            sweep=record.id,
            points=len(points),
        )
        chunk = ChunkPlan(sweep=record.id, first=points.start, end=points.stop)
        store.jobs.create(job, chunk.model_dump_json().encode())
        jobs.append(job)
    return record, jobs


def _enqueue(store: Store, record: SweepRecord, jobs: list[JobRecord]) -> None:
    """Queue all jobs, or leave nothing of the sweep behind."""
    try:
        for job in jobs:
            store.queue.enqueue(job.id)
    except QueueFull:
        stop(store, record)
        forget(store, record)
        raise
