"""Simulations: post one. From then on it is a job as any other."""

from fastapi import APIRouter, Response
from fastapi.concurrency import run_in_threadpool

from api.bodies import JsonBody
from api.context import Ctx, Owner
from api.openapi import request_body
from api.posting import REPLIES, IdempotencyKey, Prefer, ValidateOnly, checked, queued
from api.submission import read_posted_simulation
from schemas.jobs import Job

router = APIRouter(prefix="/v1/simulations", tags=["simulations"])


@router.post(
    "",
    status_code=202,
    response_model=Job,
    responses=REPLIES,
    openapi_extra=request_body("Simulation"),
)
async def post_simulation(
    ctx: Ctx,
    owner: Owner,
    body: JsonBody,
    idempotency_key: IdempotencyKey = None,
    prefer: Prefer = None,
    validate_only: ValidateOnly = False,
) -> Response:
    """Queue a simulation. The answer comes once the job is on disk; GET /v1/jobs/{id} follows."""
    draft = await run_in_threadpool(read_posted_simulation, ctx, body, owner)
    if validate_only:
        return checked(draft)
    return await queued(ctx, draft, owner, idempotency_key, prefer)
