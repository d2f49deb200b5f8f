"""All jobs: post a problem, list what was posted."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from fastapi.concurrency import run_in_threadpool

from api.bodies import JsonBody
from api.context import Ctx, Owner
from api.errors import BadParameter
from api.openapi import errors, request_body
from api.posting import REPLIES, IdempotencyKey, Prefer, ValidateOnly, checked, queued
from api.submission import read
from api.views import page_view
from schemas.errors import BadProblem
from schemas.jobs import Job, JobKind, JobPage, JobStatus

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@router.post(
    "",
    status_code=202,
    response_model=Job,
    responses=REPLIES,
    openapi_extra=request_body("Problem"),
)
async def post_job(
    ctx: Ctx,
    owner: Owner,
    body: JsonBody,
    idempotency_key: IdempotencyKey = None,
    prefer: Prefer = None,
    validate_only: ValidateOnly = False,
) -> Response:
    """Queue a problem. The answer comes once the job is on disk."""
    draft = await run_in_threadpool(read, ctx, body, owner)
    if validate_only:
        return checked(draft)
    return await queued(ctx, draft, owner, idempotency_key, prefer)


@router.get("", response_model=JobPage, responses=errors(422))
def get_jobs(
    ctx: Ctx,
    owner: Owner,
    status: Annotated[JobStatus | None, Query()] = None,
    name: Annotated[str | None, Query(max_length=200, description="The exact name.")] = None,
    kind: Annotated[JobKind | None, Query(description="What the jobs do.")] = None,
    cursor: Annotated[str | None, Query(max_length=200, description="'next' of a page.")] = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
) -> Response:
    """Your jobs, newest first."""
    try:
        page = ctx.store.jobs.list(
            owner, status=status, name=name, kind=kind, cursor=cursor, limit=limit
        )
    except BadProblem as error:
        issue = error.issues[0]
        raise BadParameter(issue.message, issue.hint, "cursor") from None
    content = page_view(page, ctx.store).model_dump_json()
    return Response(content, media_type="application/json", headers={"Cache-Control": "no-store"})
