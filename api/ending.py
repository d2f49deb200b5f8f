"""How a job or a sweep is told to end: what the body says, and who insists."""

from typing import Literal

from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from api.context import Context
from api.errors import BadParameter
from api.stopping import cancel
from schemas.jobs import JobStatus
from store.ports import JobRecord


class Cancellation(BaseModel):
    """How a job is cancelled: asked first and killed after a second, or killed now."""

    model_config = ConfigDict(extra="forbid")
    mode: Literal["cooperative", "now"] = Field(
        default="cooperative", description="'now' kills without asking first."
    )


async def end(ctx: Context, record: JobRecord, *, kill: bool) -> JobRecord:
    """Cancel a job, and see to it that it ends."""
    record = await run_in_threadpool(cancel, ctx.store, record)
    if record.status is JobStatus.CANCELLING:
        if kill:
            await run_in_threadpool(ctx.store.queue.stop, record.id)
        ctx.stopper.watch(record.id)
    return record


def read_mode(body: bytes) -> str:
    """The mode of a cancellation; nothing stands for the gentle one. Raises BadParameter."""
    try:
        return Cancellation.model_validate_json(body).mode if body else "cooperative"
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        hint = """Send nothing, or {"mode": "cooperative"} or {"mode": "now"}."""
        raise BadParameter(f"{place or 'body'}: {first['msg']}", hint, place or "body") from None
