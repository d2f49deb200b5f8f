"""One job: look, cancel, delete."""

from typing import Annotated

import anyio
from fastapi import APIRouter, Header, Query, Response
from fastapi.concurrency import run_in_threadpool

from api.bodies import OptionalJsonBody
from api.context import Context, Ctx, OwnJob
from api.ending import end, read_mode
from api.openapi import errors, request_body
from api.views import job_response, job_view, matches
from api.waiting import MAX_WAIT, follow
from schemas.errors import Conflict
from schemas.jobs import TERMINAL, Job, JobKind
from store.ports import JobRecord

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["jobs"])


@router.get(
    "",
    response_model=Job,
    responses=errors(
        404, 422, also={304: {"description": "It is still what If-None-Match names."}}
    ),
)
async def get_job(
    ctx: Ctx,
    record: OwnJob,
    wait: Annotated[int, Query(ge=0, le=MAX_WAIT, description="Seconds to wait.")] = 0,
    if_none_match: Annotated[str | None, Header()] = None,
) -> Response:
    """How a job is doing. ``wait`` holds the answer until the job has ended.

    Together with If-None-Match it holds the answer until anything has changed.
    """
    live = wait > 0 and record.status not in TERMINAL
    response = await run_in_threadpool(_current, ctx, record)
    if live and (not if_none_match or matches(if_none_match, response.headers["ETag"])):
        response = await _long_poll(ctx, record, wait, if_none_match)
    if matches(if_none_match, response.headers["ETag"]):
        return Response(status_code=304, headers={"ETag": response.headers["ETag"]})
    return response


@router.post(
    "/cancel",
    status_code=202,
    response_model=Job,
    responses=errors(404, 408, 409, 413, 415, 422),
    openapi_extra=request_body("Cancellation", required=False),
)
async def post_cancel(ctx: Ctx, record: OwnJob, body: OptionalJsonBody) -> Response:
    """Cancel a job; again is no error. A running solve keeps its best iterate as the result."""
    record = await end(ctx, record, kill=read_mode(body) == "now")
    return await run_in_threadpool(_current, ctx, record, 202)


@router.delete(
    "",
    status_code=204,
    responses=errors(
        404, 409, also={202: {"model": Job, "description": "It was live and is being cancelled."}}
    ),
)
async def delete_job(ctx: Ctx, record: OwnJob) -> Response:
    """Cancel a live job; forget an ended one with its result and events."""
    if record.kind is JobKind.SWEEP_CHUNK:
        words = "The job solves points of a sweep and is forgotten with it."
        raise Conflict(words, f"DELETE /v1/sweeps/{record.sweep} forgets the sweep.")
    if record.status in TERMINAL:
        await run_in_threadpool(ctx.store.jobs.delete, record.id, record.owner)
        return Response(status_code=204)
    record = await end(ctx, record, kill=False)
    return await run_in_threadpool(_current, ctx, record, 202)


async def _long_poll(ctx: Context, record: JobRecord, seconds: int, known: str | None) -> Response:
    """The job once it has ended, or no longer is what ``known`` names, or the time is over."""
    latest = await run_in_threadpool(ctx.store.events.read, record.id)
    with anyio.move_on_after(seconds):
        async for _ in follow(ctx, record.id, latest[-1].id if latest else "0"):
            if known:
                response = await run_in_threadpool(_fresh, ctx, record)
                if not matches(known, response.headers["ETag"]):
                    return response
    return await run_in_threadpool(_fresh, ctx, record)


def _fresh(ctx: Context, record: JobRecord) -> Response:
    return _current(ctx, ctx.store.jobs.get(record.id, record.owner))


def _current(ctx: Context, record: JobRecord, status: int = 200) -> Response:
    return job_response(job_view(record, ctx.store), status)
