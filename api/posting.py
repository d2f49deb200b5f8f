"""How problems and simulations are posted: checked only, or queued, perhaps waited for."""

import re
from typing import Annotated

from fastapi import Header, Query, Response
from fastapi.concurrency import run_in_threadpool

from api.context import Context
from api.openapi import Responses, errors
from api.submission import Draft, Validation, submit
from api.views import job_response, job_view
from api.waiting import MAX_WAIT, until_ended
from schemas.jobs import TERMINAL, Job
from store.ports import JobRecord

IdempotencyKey = Annotated[
    str | None,
    Header(
        min_length=1,
        max_length=200,
        pattern=r"^[\x21-\x7e]+$",
        description="Posting again with the same key within 24 hours makes no second job.",
    ),
]
Prefer = Annotated[
    str | None,
    Header(description=f"wait=N answers when the job has ended, or in N s (<= {MAX_WAIT})."),
]
ValidateOnly = Annotated[bool, Query(description="Check what is posted, store nothing.")]

REPLIES: Responses = errors(
    *(408, 409, 413, 415, 422, 429),
    also={200: {"model": Job | Validation, "description": "Ended in time, or only checked."}},
)


def checked(draft: Draft) -> Response:
    """The answer where nothing is to be stored."""
    return Response(draft.validation().model_dump_json(), media_type="application/json")


async def queued(
    ctx: Context, draft: Draft, owner: str, key: str | None, prefer: str | None
) -> Response:
    """Store and queue the draft; the job, once it is on disk or has ended."""
    record, replayed = await run_in_threadpool(submit, ctx, draft, owner, key)
    headers = {"Location": f"/v1/jobs/{record.id}"}
    if replayed:
        headers["Idempotency-Replayed"] = "true"
    wait = _preferred_wait(prefer)
    if wait is not None:
        headers["Preference-Applied"] = f"wait={wait}"
        record = await until_ended(ctx, record, wait)
    return await run_in_threadpool(_answer, ctx, record, headers, wait is not None)


def _answer(ctx: Context, record: JobRecord, headers: dict[str, str], waited: bool) -> Response:
    job = job_view(record, ctx.store)
    if waited and record.status in TERMINAL:
        return job_response(job, 200, headers, ctx.store.results.get(record.id))
    return job_response(job, 202, headers | {"Retry-After": "1"})


def _preferred_wait(prefer: str | None) -> int | None:
    """The N of ``wait=N``, capped. A preference that cannot be read is no error (RFC 7240)."""
    found = re.search(r"(?:^|[,;\s])wait\s*=\s*\"?(\d{1,9})(?!\d)", prefer or "", re.IGNORECASE)
    return min(int(found[1]), MAX_WAIT) if found else None
