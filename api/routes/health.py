"""For whoever runs the service: alive, ready, metrics. Open to all, and tells nothing of a user."""

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST
from pydantic import BaseModel

from api.context import Ctx
from api.errors import NotReady
from api.openapi import errors, texts
from schemas.errors import StoreUnavailable

router = APIRouter(tags=["operations"])


class Alive(BaseModel):
    """The process answers."""

    status: str = "alive"


class Ready(BaseModel):
    """Work can be taken."""

    status: str = "ready"
    workers: int
    waiting: int


@router.get("/livez")
async def get_livez() -> Alive:
    """Whether this process is alive; asks nobody else."""
    return Alive()


@router.get("/readyz", responses=errors(503))
def get_readyz(ctx: Ctx) -> Ready:
    """Whether jobs can be taken and solved: the queue server answers and a worker is there."""
    try:
        ctx.store.ping()
        workers, waiting = len(ctx.store.queue.workers()), ctx.store.queue.length()
    except StoreUnavailable as error:
        raise NotReady(f"The queue server is away: {error.message}") from error
    if workers == 0:
        words = f"The queue server answers, but no worker is there; {waiting} jobs wait."
        raise NotReady(words, "Start one with 'footfall worker'.")
    return Ready(workers=workers, waiting=waiting)


@router.get(
    "/metrics",
    response_class=Response,
    responses=texts("text/plain"),
)
def get_metrics(ctx: Ctx) -> Response:
    """Metrics in Prometheus' text format."""
    return Response(ctx.metrics.page(), headers={"Content-Type": CONTENT_TYPE_LATEST})
