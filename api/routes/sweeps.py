"""All sweeps: post one, list them."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from api.bodies import JsonBody
from api.context import Ctx, Owner
from api.errors import BadParameter
from api.openapi import errors, request_body
from api.posting import IdempotencyKey
from api.sweep_views import State, sweep_response, sweep_view
from api.sweeping import SweepValidation, read, submit, validation
from schemas.errors import BadProblem
from schemas.sweeps import Sweep, SweepPage

router = APIRouter(prefix="/v1/sweeps", tags=["sweeps"])
_JSON = "application/json"


@router.post(
    "",
    status_code=202,
    response_model=Sweep,
    responses=errors(
        *(408, 409, 413, 415, 422, 429),
        also={200: {"model": SweepValidation, "description": "Only checked."}},
    ),
    openapi_extra=request_body("SweepRequest"),
)
def post_sweep(
    ctx: Ctx,
    owner: Owner,
    body: JsonBody,
    idempotency_key: IdempotencyKey = None,
    validate_only: Annotated[bool, Query(description="Check the sweep, store nothing.")] = False,
) -> Response:
    """Queue a problem at many places. The answer comes once all of its jobs are on disk."""
    plan = read(ctx, body, owner)
    if validate_only:
        return Response(validation(plan).model_dump_json(), media_type=_JSON)
    record, replayed = submit(ctx, plan, body, owner, idempotency_key)
    headers = {"Location": f"/v1/sweeps/{record.id}", "Retry-After": "1"}
    if replayed:
        headers["Idempotency-Replayed"] = "true"
    return sweep_response(State.read(ctx.store, record), 202, headers)


@router.get("", response_model=SweepPage, responses=errors(422))
def get_sweeps(
    ctx: Ctx,
    owner: Owner,
    cursor: Annotated[str | None, Query(max_length=200, description="'next' of a page.")] = None,
    limit: Annotated[int, Query(ge=1, le=50)] = 20,
) -> Response:
    """Your sweeps, newest first, without their points."""
    try:
        page = ctx.store.sweeps.list(owner, cursor=cursor, limit=limit)
    except BadProblem as error:
        issue = error.issues[0]
        raise BadParameter(issue.message, issue.hint, "cursor") from None
    sweeps = [sweep_view(State.read(ctx.store, record), whole=False) for record in page.records]
    content = SweepPage(sweeps=sweeps, next=page.next).model_dump_json()
    return Response(content, media_type=_JSON, headers={"Cache-Control": "no-store"})
