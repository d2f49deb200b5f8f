"""What there is: examples, methods, backends, the schema of problems, the limits."""

import inspect
from functools import cache
from typing import Annotated, Any, Literal, get_args

from fastapi import APIRouter, Depends, Path
from fastapi.responses import JSONResponse
from pydantic import BaseModel

import examples
from api.context import Ctx, require_owner
from api.errors import NoRoute
from api.limits import ServiceLimits, limits
from api.openapi import errors
from api.published import schema_of
from schemas.base import Posted
from schemas.methods import METHODS, SCHEDULES
from schemas.problem import Problem
from schemas.simulations import SIMULATION_METHODS, Simulation
from schemas.suggest import did_you_mean

router = APIRouter(prefix="/v1", tags=["catalogue"], dependencies=[Depends(require_owner)])


class Example(BaseModel):
    """One document of the gallery. ``href`` serves it, ready to be posted to ``post``."""

    name: str
    kind: Literal["problem", "simulation"]
    post: str
    title: str
    description: str
    href: str


class Examples(BaseModel):
    """The gallery."""

    examples: list[Example]


class MethodInfo(BaseModel):
    """One method, and the JSON Schema of its settings."""

    kind: str
    title: str
    description: str
    settings: dict[str, Any]


class Methods(BaseModel):
    """The methods that a problem may ask for, and those of a simulation."""

    methods: list[MethodInfo]
    simulation_methods: list[MethodInfo]


class BackendInfo(BaseModel):
    """One NLP solver, and how many live workers have it."""

    name: str
    workers: int


class Backends(BaseModel):
    """The NLP solvers of the live workers, and those workers."""

    backends: list[BackendInfo]
    workers: list[dict[str, Any]]


@router.get("/examples")
def get_examples() -> Examples:
    """The gallery: problems and simulations that can be posted as they are."""
    return Examples(examples=[_example(name) for name in _gallery()])


@router.get("/examples/{name}", responses=errors(404))
def get_example(
    name: Annotated[str, Path(description="As the gallery lists it.")],
) -> dict[str, Any]:
    """One document of the gallery."""
    names = _gallery()
    if name not in names:
        hint = did_you_mean(name, names) or "GET /v1/examples lists them."
        raise NoRoute("There is no such example.", hint)
    return examples.load(name)


@router.get("/methods")
def get_methods() -> Methods:
    """The methods of problems and of simulations, with the JSON Schema of their settings."""
    return Methods(
        methods=_methods((*METHODS, *SCHEDULES)), simulation_methods=_methods(SIMULATION_METHODS)
    )


@router.get("/backends")
def get_backends(ctx: Ctx) -> Backends:
    """The NLP solvers there are, as the live workers tell."""
    workers = ctx.store.queue.workers()
    names = [name for worker in workers for name in _backends(worker)]
    found = [BackendInfo(name=name, workers=names.count(name)) for name in sorted(set(names))]
    return Backends(backends=found, workers=workers)


class SchemaResponse(JSONResponse):
    """A JSON Schema."""

    media_type = "application/schema+json"


@router.get("/schema", response_class=SchemaResponse)
def get_schema() -> SchemaResponse:
    """The JSON Schema (2020-12) of a problem."""
    return SchemaResponse(schema_of(Problem))


@router.get("/schema/simulation", response_class=SchemaResponse)
def get_simulation_schema() -> SchemaResponse:
    """The JSON Schema (2020-12) of a simulation."""
    return SchemaResponse(schema_of(Simulation))


@router.get("/limits")
def get_limits(ctx: Ctx) -> ServiceLimits:
    """Every limit of this service in one table."""
    return limits(ctx.settings)


def _gallery() -> list[str]:
    return [*examples.names(), *examples.simulations()]


def _example(name: str) -> Example:
    document = examples.load(name)
    simulated = "phases" not in document
    return Example(
        name=name,
        kind="simulation" if simulated else "problem",
        post="/v1/simulations" if simulated else "/v1/jobs",
        title=str(document.get("name", name)),
        description=str(document.get("description", "")),
        href=f"/v1/examples/{name}",
    )


@cache
def _methods(models: tuple[type[Posted], ...]) -> list[MethodInfo]:
    found = []
    for model in models:
        title, _, words = (inspect.getdoc(model) or "").partition("\n")
        (kind,) = get_args(model.model_fields["kind"].annotation)
        schema = model.model_json_schema()
        found.append(MethodInfo(kind=kind, title=title, description=words.strip(), settings=schema))
    return found


def _backends(worker: dict[str, object]) -> list[str]:
    names = worker.get("backends")
    return [str(name) for name in names] if isinstance(names, list) else []
