"""Results of earlier jobs: served as they are, or as the start of another solve."""

from typing import Any

import orjson

import examples
from api.context import JOB_ID
from schemas.errors import NoResult, ResultExpired, ResultNotReady, UnknownJob
from schemas.inlining import Sources
from schemas.jobs import TERMINAL, JobKind, JobStatus
from store.ports import JobRecord, Store


def sources(store: Store, owner: str) -> Sources:
    """What the names in an owner's problem lead to: the gallery, and their own ended jobs."""

    def result(job_id: str) -> dict[str, Any]:
        if not JOB_ID.fullmatch(job_id):
            raise UnknownJob("There is no such job.", "An id is 32 characters of 0-9 and a-f.")
        record = store.jobs.get(job_id, owner)
        content = store.results.get(job_id) if record.status in TERMINAL else None
        if content is None:
            raise absent(record, "result")
        return dict(orjson.loads(content))

    return Sources(lambda: [*examples.names(), *examples.simulations()], examples.load, result)


def absent(record: JobRecord, what: str) -> ResultNotReady | ResultExpired | NoResult:
    """Why a job has no result or report: not yet, no longer, or never."""
    if record.kind is JobKind.SWEEP_CHUNK:
        return NoResult(
            "The job solves points of a sweep.",
            f"Each has its own result: see /v1/sweeps/{record.sweep}.",
        )
    if record.status not in TERMINAL:
        return ResultNotReady(
            f"The job is {record.status}; it has no {what} yet.",
            "Follow its events, or poll it with ?wait=60.",
        )
    if record.status is JobStatus.EXPIRED or (what == "result" and record.has_result):
        return ResultExpired(f"The {what} was kept for its time.", "Post the problem again.")
    reason = record.error.message if record.error else record.message
    return NoResult(f"The job ended as {record.status} without a {what}. {reason}".strip())
