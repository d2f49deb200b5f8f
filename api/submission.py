"""From a posted body to a queued job that survives a crash."""

import hashlib
import time
import uuid
from dataclasses import dataclass

from pydantic import BaseModel, Field

from api.advice import lowered, warnings
from api.context import Context
from api.earlier import sources
from api.once import Made, once
from schemas.errors import QueueFull, RateLimited
from schemas.inlining import inlined, inlined_simulation
from schemas.jobs import JobKind, JobStatus
from schemas.problem import Limits, Problem
from schemas.reading import read_problem, spec_sha256, written
from schemas.remarks import simulated_remarks
from schemas.simulations import Simulation, read_simulation
from store.ports import JobRecord, Store


class Validation(BaseModel):
    """What ``?validate_only=true`` answers for a good problem or simulation."""

    valid: bool = True
    name: str
    spec_sha256: str
    limits: Limits = Field(description="What the job may use, after the service's caps.")
    warnings: list[str]


@dataclass(frozen=True, slots=True)
class Draft:
    """A good problem or simulation, ready to be stored.

    ``fingerprint`` is of the request: its kind, and the body as it was posted.
    """

    kind: JobKind
    document: Problem | Simulation
    fingerprint: str
    warnings: list[str]

    def validation(self) -> Validation:
        """The answer when nothing is to be stored."""
        return Validation(
            name=self.document.name,
            spec_sha256=spec_sha256(self.document),
            limits=self.document.limits,
            warnings=self.warnings,
        )


def read(ctx: Context, body: bytes, owner: str) -> Draft:
    """Check a posted problem, put in what it names, cap what it asks for. Raises BadProblem."""
    found = sources(ctx.store, owner)
    problem = read_problem(body, lambda document: inlined(document, found))
    limits = _capped(ctx, problem.limits)
    capped = problem.model_copy(update={"limits": limits})
    return Draft(JobKind.SOLVE, capped, _fingerprint(body), warnings(problem, limits))


def read_posted_simulation(ctx: Context, body: bytes, owner: str) -> Draft:
    """As `read`, for a simulation."""
    found = sources(ctx.store, owner)
    simulation = read_simulation(body, lambda document: inlined_simulation(document, found))
    limits = _capped(ctx, simulation.limits)
    capped = simulation.model_copy(update={"limits": limits})
    notes = [*lowered(simulation.limits, limits), *simulated_remarks(simulation)]
    return Draft(JobKind.SIMULATION, capped, _fingerprint(b"simulation\n" + body), notes)


def _capped(ctx: Context, asked: Limits) -> Limits:
    caps = ctx.settings
    return Limits(
        seconds=min(asked.seconds, caps.max_seconds),
        megabytes=min(asked.megabytes, caps.max_megabytes),
    )


def _fingerprint(request: bytes) -> str:
    return hashlib.sha256(request).hexdigest()


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
    limits = draft.document.limits
    record = JobRecord(
        id=uuid.uuid4().hex,
        owner=owner,
        name=draft.document.name,
        spec_sha256=spec_sha256(draft.document),
        status=JobStatus.QUEUED,
        created=time.time(),
        seconds=limits.seconds,
        megabytes=limits.megabytes,
        kind=draft.kind,
    )
    ctx.store.jobs.create(record, written(draft.document))
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
