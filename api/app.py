"""The app, put together from its parts."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import PackageNotFoundError, version

from anyio import CapacityLimiter
from fastapi import Depends, FastAPI
from fastapi.middleware import Middleware
from pydantic import BaseModel

from api import problems
from api.context import Context, require_owner
from api.ending import Cancellation
from api.guards import BodyGuard, HeadAsGet, HostGuard
from api.metrics import Metrics
from api.observing import Observer
from api.openapi import document, errors
from api.routes import (
    catalogue,
    events,
    health,
    job,
    jobs,
    pages,
    results,
    simulations,
    sweep,
    sweeps,
)
from api.settings import ApiSettings
from api.stopping import Stopper
from schemas.problem import Problem
from schemas.simulations import Simulation
from schemas.sweeps import SweepRequest
from store.ports import Store

_WAITERS = 64
_OWNED = (jobs, simulations, job, results, events, sweeps, sweep, catalogue)
_OPEN = (health, pages)
_POSTED: list[type[BaseModel]] = [
    Problem,
    Simulation,
    SweepRequest,
    Cancellation,
    problems.ProblemDetail,
]


def create_app(store: Store, settings: ApiSettings) -> FastAPI:
    """The service over a store. Opens no connection by itself.

    Parameters
    ----------
    store : Store
        All ports of one server.
    settings : ApiSettings
        Limits, keys and names. Whether they are safe to serve with, ``serve`` checks.
    """
    metrics = Metrics(store)
    stopper = Stopper(store, settings.stop_grace)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        yield
        await stopper.close()

    app = FastAPI(
        title="Footfall",
        summary="Trajectory optimization, also through contact, as a service.",
        version=_version(),
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=lifespan,
        middleware=[
            Middleware(Observer, metrics=metrics),
            Middleware(HostGuard, settings=settings),
            Middleware(HeadAsGet),
            Middleware(BodyGuard, settings=settings),
        ],
    )
    app.state.context = Context(store, settings, metrics, stopper, CapacityLimiter(_WAITERS))
    problems.install(app)
    for module in _OWNED:
        guard = [Depends(require_owner)]
        app.include_router(module.router, dependencies=guard, responses=errors(401, 503))
    for module in _OPEN:
        app.include_router(module.router)
    app.openapi = document(app, _POSTED)  # type: ignore[method-assign]
    return app


def _version() -> str:
    try:
        return version("footfall-server")
    except PackageNotFoundError:  # run from a checkout that was never installed
        return "0"
