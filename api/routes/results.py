"""What a job has made: the result, the trajectory resampled from it, the report."""

import logging
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Header, Query, Response

from api.context import Context, Ctx, OwnJob
from api.earlier import absent
from api.errors import BadParameter, NotAcceptable
from api.negotiation import choose
from api.openapi import errors, texts
from api.trajectory import CSV, JSON, NPZ, Grid, Trajectory, encode, sample
from api.views import etag, matches
from footfall.report import render
from schemas.jobs import TERMINAL
from schemas.results import Solution
from schemas.simulated import SimulationResult
from store.ports import JobRecord

logger = logging.getLogger("footfall.api")
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
)
"""The report is one file with its own script and style, may load nothing, and runs without an
origin of its own: even a script smuggled into it could not reach this service."""


@router.get(
    "/result",
    response_model=Solution | SimulationResult,
    responses=errors(404, 409, 410, also={304: {"description": "It is what If-None-Match names."}}),
)
def get_result(
    ctx: Ctx, record: OwnJob, if_none_match: Annotated[str | None, Header()] = None
) -> Response:
    """The result, as the worker stored it; of a cancelled or failed job too, if it got so far."""
    content = _result(ctx, record)
    headers = {"ETag": etag(content), "Cache-Control": "private, no-cache"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return Response(content, headers=headers, media_type=JSON)


@router.get(
    "/trajectory",
    response_model=Trajectory,
    responses=errors(404, 406, 409, 410, 422, also=texts(CSV, NPZ)),
)
def get_trajectory(
    ctx: Ctx,
    record: OwnJob,
    samples: Annotated[
        int | None, Query(ge=2, description="Times per phase, ends included.")
    ] = None,
    dt: Annotated[
        float | None, Query(gt=0, allow_inf_nan=False, description="Seconds from time to time.")
    ] = None,
    fields: Annotated[
        str | None,
        Query(max_length=4000, description="Names (q1) or groups (controls), comma between them."),
    ] = None,
    accept: Annotated[str | None, Header()] = None,
) -> Response:
    """The result's curves at times of your choice, without solving again."""
    media_type = choose(accept, (JSON, CSV, NPZ))
    if media_type is None:
        raise NotAcceptable(
            "A trajectory is served in none of these types.", f"{JSON}, {CSV}, {NPZ}"
        )
    if samples is not None and dt is not None:
        raise BadParameter("samples and dt exclude each other.", "Give one of them.", "dt")
    grid = Grid(samples, dt, ctx.settings.max_samples)
    result: dict[str, Any] = orjson.loads(_result(ctx, record))
    names = None if fields is None else [part.strip() for part in fields.split(",")]
    content = encode(sample(result, grid, names), media_type)
    headers = {"Cache-Control": "private, no-cache", "Vary": "Accept"}
    return Response(content, headers=headers, media_type=media_type)


@router.get(
    "/report.html",
    response_class=Response,
    responses=errors(404, 409, 410, also=texts("text/html")),
)
def get_report(ctx: Ctx, record: OwnJob) -> Response:
    """A self-contained page about the result."""
    page = ctx.store.results.report(record.id) or _drawn(ctx, record)
    if page is None:
        raise absent(record, "report")
    headers = {"Content-Security-Policy": REPORT_POLICY, "Cache-Control": "private, no-cache"}
    return Response(page, headers=headers, media_type="text/html")


def _drawn(ctx: Context, record: JobRecord) -> bytes | None:
    """The page, where the worker has not made it yet, or was killed and has left a result only."""
    result = ctx.store.results.get(record.id) if record.status in TERMINAL else None
    if result is None:
        return None
    problem = ctx.store.jobs.problem(record.id)
    try:
        return render(orjson.loads(result), orjson.loads(problem)).encode()
    except Exception:  # as in the worker: the page is an extra, and its lack has an answer
        logger.exception("job %s: the report could not be made", record.id)
        return None


def _result(ctx: Context, record: JobRecord) -> bytes:
    content = ctx.store.results.get(record.id)
    if content is None:
        raise absent(record, "result")
    return content
