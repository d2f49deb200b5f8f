"""All jobs: post one, list them."""

import re
from typing import Annotated

from fastapi import APIRouter, Header, Query, Response
from fastapi.concurrency import run_in_threadpool

from api.bodies import JsonBody
from api.context import Context, Ctx, Owner
from api.errors import BadParameter
from api.openapi import errors, request_body
from api.submission import Validation, read, submit
from api.views import job_response, job_view, page_view
from api.waiting import MAX_WAIT, until_ended
from schemas.errors import BadProblem
from schemas.jobs import TERMINAL, Job, JobPage, JobStatus
from store.ports import JobRecord

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


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


@router.post(
    "",
    status_code=202,
    response_model=Job,
    responses=errors(
        *(408, 409, 413, 415, 422, 429),
        also={200: {"model": Job | Validation, "description": "Ended in time, or only checked."}},
    ),
    openapi_extra=request_body("Problem"),
)
async def post_job(
    ctx: Ctx,
    owner: Owner,
    body: JsonBody,
    idempotency_key: IdempotencyKey = None,
    prefer: Prefer = None,
    validate_only: Annotated[bool, Query(description="Check the problem, store nothing.")] = False,
) -> Response:
    """Queue a problem. The answer comes once the job is on disk."""
    draft = await run_in_threadpool(read, ctx, body, owner)
    if validate_only:
        content = draft.validation().model_dump_json()
        return Response(content, media_type="application/json")
    record, replayed = await run_in_threadpool(submit, ctx, draft, owner, idempotency_key)
    headers = {"Location": f"/v1/jobs/{record.id}"}
    if replayed:
        headers["Idempotency-Replayed"] = "true"
    wait = _preferred_wait(prefer)
    if wait is not None:
        headers["Preference-Applied"] = f"wait={wait}"
        record = await until_ended(ctx, record, wait)
    return await run_in_threadpool(_submitted, ctx, record, headers, wait is not None)


def _submitted(ctx: Context, record: JobRecord, headers: dict[str, str], waited: bool) -> Response:
    job = job_view(record, ctx.store)
    if waited and record.status in TERMINAL:
        return job_response(job, 200, headers, ctx.store.results.get(record.id))
    return job_response(job, 202, headers | {"Retry-After": "1"})


def _preferred_wait(prefer: str | None) -> int | None:
    """The N of ``wait=N``, capped. A preference that cannot be read is no error (RFC 7240)."""
    found = re.search(r"(?:^|[,;\s])wait\s*=\s*\"?(\d{1,9})(?!\d)", prefer or "", re.IGNORECASE)
    return min(int(found[1]), MAX_WAIT) if found else None


@router.get("", response_model=JobPage, responses=errors(422))
def get_jobs(
    ctx: Ctx,
    owner: Owner,
    status: Annotated[JobStatus | None, Query()] = None,
    name: Annotated[str | None, Query(max_length=200, description="The exact name.")] = None,
    cursor: Annotated[str | None, Query(max_length=200, description="'next' of a page.")] = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> Response:
    """Your jobs, newest first."""
    try:
        page = ctx.store.jobs.list(owner, status=status, name=name, cursor=cursor, limit=limit)
    except BadProblem as error:
        issue = error.issues[0]
        raise BadParameter(issue.message, issue.hint, "cursor") from None
    content = page_view(page, ctx.store).model_dump_json()
    return Response(content, media_type="application/json", headers={"Cache-Control": "no-store"})
