"""From a posted body to a queued job that survives a crash."""

import hashlib
import time
import uuid
from dataclasses import dataclass

from pydantic import BaseModel, Field

from api.advice import warnings
from api.context import Context
from api.earlier import sources
from api.once import Made, once
from schemas.errors import QueueFull, RateLimited
from schemas.inlining import inlined
from schemas.jobs import JobStatus
from schemas.problem import Limits, Problem
from schemas.reading import canonical, read_problem, spec_sha256
from store.ports import JobRecord, Store


class Validation(BaseModel):
    """What ``?validate_only=true`` answers for a good problem."""

    valid: bool = True
    name: str
    spec_sha256: str
    limits: Limits = Field(description="What the solve may use, after the service's caps.")
    warnings: list[str]


@dataclass(frozen=True, slots=True)
class Draft:
    """A good problem, ready to be stored. ``fingerprint`` is of the body as it was posted."""

    problem: Problem
    fingerprint: str
    warnings: list[str]

    def validation(self) -> Validation:
        """The answer when nothing is to be stored."""
        return Validation(
            name=self.problem.name,
            spec_sha256=spec_sha256(self.problem),
            limits=self.problem.limits,
            warnings=self.warnings,
        )


def read(ctx: Context, body: bytes, owner: str) -> Draft:
    """Check a posted problem, put in what it names, cap what it asks for. Raises BadProblem."""
    found = sources(ctx.store, owner)
    problem = read_problem(body, lambda document: inlined(document, found))
    asked, caps = problem.limits, ctx.settings
    limits = Limits(
        seconds=min(asked.seconds, caps.max_seconds),
        megabytes=min(asked.megabytes, caps.max_megabytes),
    )
    capped = problem.model_copy(update={"limits": limits})
    return Draft(capped, hashlib.sha256(body).hexdigest(), warnings(problem, limits))


def submit(ctx: Context, draft: Draft, owner: str, key: str | None) -> tuple[JobRecord, bool]:
    """Store and queue a job; returns once it is on disk. True: the key's own job of before.

    Raises Conflict or KeyReused (see ``once``), QueueFull, RateLimited, StoreUnavailable.
    """

    def make(made: Made) -> JobRecord:
        check_share(ctx, owner)
        record = _create(ctx, draft, owner)
        made(record.id)
        _enqueue(ctx.store, record)
        ctx.metrics.accepted()
        return record

    def find(job_id: str) -> JobRecord:
        return ctx.store.jobs.get(job_id, owner)

    return once(ctx.store, (owner, key), draft.fingerprint, make, find)


def _create(ctx: Context, draft: Draft, owner: str) -> JobRecord:
    """The record comes first: whoever finds the id in the queue finds the job."""
    limits = draft.problem.limits
    record = JobRecord(
        id=uuid.uuid4().hex,
        owner=owner,
        name=draft.problem.name,
        spec_sha256=spec_sha256(draft.problem),
        status=JobStatus.QUEUED,
        created=time.time(),
        seconds=limits.seconds,
        megabytes=limits.megabytes,
    )
    ctx.store.jobs.create(record, canonical(draft.problem))
    return record


def _enqueue(store: Store, record: JobRecord) -> None:
    """Queue the job, or leave nothing of it behind."""
    try:
        store.queue.enqueue(record.id)
    except QueueFull:
        store.jobs.move(record.id, JobStatus.FAILED, expect=frozenset({JobStatus.QUEUED}))
        store.jobs.delete(record.id, record.owner)
        raise


def check_share(ctx: Context, owner: str, more: int = 1) -> None:
    """One owner's waiting jobs are capped, so that none fills the queue for the rest."""
    cap = ctx.settings.max_waiting_jobs
    if ctx.store.queue.length() + more <= cap:  # then nobody has as many; most requests end here
        return
    live = ctx.store.jobs.live()
    waiting = sum(job.owner == owner and job.status is JobStatus.QUEUED for job in live)
    if waiting + more > cap:
        words = f"{waiting} of your jobs wait; at most {cap} may."
        raise RateLimited(words, "Wait for some to start, or cancel them.")
