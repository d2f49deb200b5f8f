"""Following a job without holding one of the threads that serve requests."""

from collections.abc import AsyncIterator

import anyio
from anyio import to_thread
from fastapi.concurrency import run_in_threadpool

from api.context import Context
from schemas.jobs import TERMINAL
from store.ports import JobRecord, LoggedEvent

MAX_WAIT = 60
"""Seconds that an answer may be held back."""

SLICE = 1.0
"""Seconds a thread waits at a time; the streams of one process take turns with theirs."""

_END = object()


async def follow(ctx: Context, job_id: str, after: str = "0") -> AsyncIterator[LoggedEvent | None]:
    """A live job's events as they come, None about once a second of silence."""
    events = ctx.store.events.follow(job_id, after, timeout=SLICE)
    while True:
        # A thread left behind on cancellation ends with its slice.
        item = await to_thread.run_sync(
            next, events, _END, abandon_on_cancel=True, limiter=ctx.waiters
        )
        if item is _END:
            return
        yield item if isinstance(item, LoggedEvent) else None


async def until_ended(ctx: Context, record: JobRecord, seconds: float) -> JobRecord:
    """The record once its job has ended, or as it is after ``seconds``."""
    if seconds <= 0 or record.status in TERMINAL:
        return record
    with anyio.move_on_after(seconds):
        async for _ in follow(ctx, record.id):
            pass
    return await run_in_threadpool(ctx.store.jobs.get, record.id, record.owner)
