"""A job's events, live (server-sent events)."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Header
from fastapi.sse import EventSourceResponse, ServerSentEvent

from api.context import Ctx, OwnJob
from api.openapi import errors
from api.waiting import follow
from schemas.errors import StoreUnavailable

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["events"])
_RETRY_MS = 2000


@router.get("/events", response_class=EventSourceResponse, responses=errors(404))
async def get_events(
    ctx: Ctx,
    record: OwnJob,
    last_event_id: Annotated[str | None, Header(description="Resumes after this event.")] = None,
) -> AsyncIterator[ServerSentEvent]:
    """Stages, NLP iterations, meshes and state changes, as they happen.

    The stream ends after the event of the job's end. On an ended job that event is sent again,
    whatever Last-Event-ID says. Comments keep a silent connection open.
    """
    yield ServerSentEvent(retry=_RETRY_MS, comment="footfall")
    try:
        async for item in follow(ctx, record.id, last_event_id or "0"):
            if item is not None:
                yield ServerSentEvent(data=item.event, event=item.event.type, id=item.id)
    except StoreUnavailable as error:
        # The answer has begun: all that is left is to end it. The client reconnects and resumes.
        yield ServerSentEvent(comment=error.message)
