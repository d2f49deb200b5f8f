"""One sweep: look, cancel, delete; the result of one of its points."""

from typing import Annotated

from fastapi import APIRouter, Header, Path, Query, Response
from fastapi.concurrency import run_in_threadpool

from api.bodies import OptionalJsonBody
from api.context import Context, Ctx, OwnSweep
from api.ending import read_mode
from api.errors import BadParameter
from api.openapi import errors, request_body
from api.sweep_views import State, sweep_response
from api.sweeping import forget, stop
from api.trajectory import JSON
from api.views import etag, matches
from schemas.errors import NoResult, ResultExpired, ResultNotReady, UnknownSweep
from schemas.results import Solution
from schemas.suggest import did_you_mean
from schemas.sweeps import ENDED, PointStatus, Sweep, SweepPoint
from store.ports import SweepRecord

router = APIRouter(prefix="/v1/sweeps/{sweep_id}", tags=["sweeps"])
_FIELDS = tuple(SweepPoint.model_fields)


@router.get("", response_model=Sweep, responses=errors(404, 422))
def get_sweep(
    ctx: Ctx,
    record: OwnSweep,
    fields: Annotated[
        str | None,
        Query(
            max_length=400,
            description="Of each point only these and its index, comma between them; empty: none.",
        ),
    ] = None,
) -> Response:
    """How a sweep is doing: counts, its points with their objectives, the minima of guesses."""
    chosen = None if fields is None else _chosen(fields)
    return sweep_response(State.read(ctx.store, record), fields=chosen)


@router.get(
    "/points/{index}/result",
    response_model=Solution,
    responses=errors(
        *(404, 409, 410, 422), also={304: {"description": "It is what If-None-Match names."}}
    ),
)
def get_point_result(
    ctx: Ctx,
    record: OwnSweep,
    index: Annotated[int, Path(ge=0, description="From 0, as the sweep lists its points.")],
    if_none_match: Annotated[str | None, Header()] = None,
) -> Response:
    """The result of one point, as the result of a job."""
    if index >= record.total:
        words = f"The sweep has no point {index}."
        raise UnknownSweep(words, f"Its points are 0 to {record.total - 1}.")
    content = ctx.store.sweeps.result(record.id, index)
    if content is None:
        raise _absent(State.read(ctx.store, record), index)
    headers = {"ETag": etag(content), "Cache-Control": "private, no-cache"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return Response(content, headers=headers, media_type=JSON)


@router.post(
    "/cancel",
    status_code=202,
    response_model=Sweep,
    responses=errors(404, 408, 409, 413, 415, 422),
    openapi_extra=request_body("Cancellation", required=False),
)
async def post_cancel_sweep(ctx: Ctx, record: OwnSweep, body: OptionalJsonBody) -> Response:
    """Cancel what has not ended yet; again is no error. Points that have ended stay."""
    return await _cancel(ctx, record, kill=read_mode(body) == "now")


@router.delete(
    "",
    status_code=204,
    responses=errors(
        *(404, 409),
        also={202: {"model": Sweep, "description": "It was live and is being cancelled."}},
    ),
)
async def delete_sweep(ctx: Ctx, record: OwnSweep) -> Response:
    """Cancel a live sweep; forget an ended one with its jobs and results."""
    state = await run_in_threadpool(State.read, ctx.store, record)
    if state.status() not in ENDED:
        return await _cancel(ctx, record, kill=False)
    await run_in_threadpool(forget, ctx.store, record)
    return Response(status_code=204)


async def _cancel(ctx: Context, record: SweepRecord, *, kill: bool) -> Response:
    for job in await run_in_threadpool(stop, ctx.store, record):
        if kill:
            await run_in_threadpool(ctx.store.queue.stop, job.id)
        ctx.stopper.watch(job.id)
    return await run_in_threadpool(_cancelled, ctx, record)


def _cancelled(ctx: Context, record: SweepRecord) -> Response:
    fresh = ctx.store.sweeps.get(record.id, record.owner)
    return sweep_response(State.read(ctx.store, fresh), 202)


def _chosen(fields: str) -> set[str]:
    """The fields of points that were asked for; ``index`` always if any."""
    names = {part.strip() for part in fields.split(",")} - {""}
    for name in sorted(names):
        if name not in _FIELDS:
            hint = did_you_mean(name, _FIELDS) or "There are " + ", ".join(_FIELDS) + "."
            raise BadParameter(f"points have no field {name!a}", hint, "fields")
    return names | {"index"} if names else names


def _absent(state: State, index: int) -> ResultNotReady | ResultExpired | NoResult:
    """Why a point has no result: not yet, no longer, or never."""
    status = state.of_point(index)
    if status in (PointStatus.QUEUED, PointStatus.RUNNING):
        return ResultNotReady(f"The point is {status}.", "Follow the sweep, or its job's events.")
    outcome = state.points.ended.get(index)
    if status is PointStatus.EXPIRED or (outcome and outcome.solution_status):
        return ResultExpired("The result was kept for its time.", "Post the point again.")
    reason = outcome.message if outcome else ""
    return NoResult(f"The point ended as {status} without a result. {reason}".strip())
