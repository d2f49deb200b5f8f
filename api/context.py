"""What every route needs, handed to it by dependency: the store, the settings, the owner."""

import hmac
import re
from dataclasses import dataclass
from typing import Annotated

from anyio import CapacityLimiter
from fastapi import Depends, Path, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from api.metrics import Metrics
from api.settings import ApiSettings
from api.stopping import Stopper
from schemas.errors import Unauthorized, UnknownJob, UnknownSweep
from store.ports import JobRecord, Store, SweepRecord

LOCAL_OWNER = "local"
JOB_ID = re.compile(r"[0-9a-f]{32}")


@dataclass(frozen=True, slots=True)
class Context:
    """The parts of one app. ``waiters`` bounds the threads that wait for events."""

    store: Store
    settings: ApiSettings
    metrics: Metrics
    stopper: Stopper
    waiters: CapacityLimiter


async def _context(request: Request) -> Context:
    context: Context = request.app.state.context
    return context


Ctx = Annotated[Context, Depends(_context)]
_bearer = HTTPBearer(auto_error=False, description="Needed where the operator has set keys.")


async def require_owner(
    ctx: Ctx, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)]
) -> str:
    """Whose request this is. Every key is compared, in constant time."""
    if not ctx.settings.keys:
        return LOCAL_OWNER
    given = credentials.credentials.encode() if credentials else b""
    owners = [
        owner
        for key, owner in ctx.settings.keys.items()
        if hmac.compare_digest(key.encode(), given)
    ]
    if not owners:
        raise Unauthorized("No known key was given.", "Send 'Authorization: Bearer KEY'.")
    return owners[0]


Owner = Annotated[str, Depends(require_owner)]


def _record(
    ctx: Ctx, owner: Owner, job_id: Annotated[str, Path(description="As the job's links name it.")]
) -> JobRecord:
    """The caller's own job; somebody else's is as unknown as one that never was."""
    if not JOB_ID.fullmatch(job_id):
        raise UnknownJob("There is no such job.", "An id is 32 characters of 0-9 and a-f.")
    return ctx.store.jobs.get(job_id, owner)


OwnJob = Annotated[JobRecord, Depends(_record)]


def _sweep(
    ctx: Ctx,
    owner: Owner,
    sweep_id: Annotated[str, Path(description="As the sweep's links name it.")],
) -> SweepRecord:
    """The caller's own sweep; a foreign one is unknown."""
    if not JOB_ID.fullmatch(sweep_id):
        raise UnknownSweep("There is no such sweep.", "An id is 32 characters of 0-9 and a-f.")
    return ctx.store.sweeps.get(sweep_id, owner)


OwnSweep = Annotated[SweepRecord, Depends(_sweep)]
