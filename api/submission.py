"""From a posted body to a queued job that survives a crash."""

import hashlib
import time
import uuid
from dataclasses import dataclass

from pydantic import BaseModel, Field

from api.advice import warnings
from api.context import Context
from api.errors import KeyReused
from schemas.errors import Conflict, QueueFull, RateLimited, UnknownJob
from schemas.jobs import JobStatus
from schemas.problem import Limits, Problem
from schemas.reading import canonical, read_problem, spec_sha256
from store.ports import KEY_REUSED, JobRecord, Store


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


def read(ctx: Context, body: bytes) -> Draft:
    """Check a posted problem and cap what it asks for. Raises BadProblem."""
    problem = read_problem(body)
    asked, caps = problem.limits, ctx.settings
    limits = Limits(
        seconds=min(asked.seconds, caps.max_seconds),
        megabytes=min(asked.megabytes, caps.max_megabytes),
    )
    capped = problem.model_copy(update={"limits": limits})
    return Draft(capped, hashlib.sha256(body).hexdigest(), warnings(problem, limits))


def submit(ctx: Context, draft: Draft, owner: str, key: str | None) -> tuple[JobRecord, bool]:
    """Store and queue a job; returns once it is on disk. True: the key's own job of before.

    Raises Conflict or KeyReused (see the store's port), QueueFull, RateLimited, StoreUnavailable.
    """
    store = ctx.store
    if key is not None:
        earlier = _begin(store, owner, key, draft.fingerprint)
        if earlier is not None:
            return _replay(ctx, earlier, owner), True
    try:
        _check_share(ctx, owner)
        record = _create(ctx, draft, owner)
        if key is not None:
            # Before the queue: should that fail halfway, the repeated request finds this job.
            store.idempotency.finish(owner, key, record.id)
        _enqueue(store, record)
    except (RateLimited, QueueFull):
        if key is not None:
            store.idempotency.abandon(owner, key)
        raise
    store.durable()
    ctx.metrics.accepted()
    return record, False


def _begin(store: Store, owner: str, key: str, fingerprint: str) -> str | None:
    try:
        return store.idempotency.begin(owner, key, fingerprint)
    except Conflict as conflict:
        if conflict.message == KEY_REUSED:
            raise KeyReused("This key came before, with another body.", conflict.hint) from None
        raise Conflict("A request with this key is still in flight.", conflict.hint) from None


def _replay(ctx: Context, job_id: str, owner: str) -> JobRecord:
    try:
        record = ctx.store.jobs.get(job_id, owner)
    except UnknownJob:
        words = "The job that this idempotency key made was deleted."
        raise Conflict(words, "Use a new key for a new job.") from None
    ctx.store.durable()  # the first request may have failed at just this
    return record


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


def _check_share(ctx: Context, owner: str) -> None:
    """One owner's waiting jobs are capped, so that none fills the queue for the rest."""
    cap = ctx.settings.max_waiting_jobs
    if ctx.store.queue.length() < cap:  # then nobody has as many; most requests end here
        return
    live = ctx.store.jobs.live()
    waiting = sum(job.owner == owner and job.status is JobStatus.QUEUED for job in live)
    if waiting >= cap:
        words = f"{waiting} of your jobs wait; at most {cap} may."
        raise RateLimited(words, "Wait for some to start, or cancel them.")
