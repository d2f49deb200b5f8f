"""Generated requests against the app: it answers as its own OpenAPI document says.

Ids of jobs are mostly replaced by those of fresh jobs, one for each state, since no generator
hits one by chance; waits are cut to nothing.
"""

from itertools import cycle
from typing import Any

import orjson
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from schemathesis import Case, HookContext
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    allow_header_conformance,
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

import examples
from api.app import create_app
from api.settings import ApiSettings
from schemas.jobs import JobKind, JobStatus
from schemas.reading import canonical, read_problem
from schemas.sweeps import PointOutcome, PointStatus, SweepPlan
from store.memory import connect
from store.ports import JobRecord, SweepRecord
from tests.support.solutions import block_move

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
    allow_header_conformance,
]
STORE = connect()
STORE.queue.announce({"name": "hand", "backends": ["ipopt"]}, ttl=3600)
APP = create_app(STORE, ApiSettings(stop_grace=60))
PROBLEM = canonical(read_problem(examples.load("block_min_force")))
RESULT = orjson.dumps(block_move())
RUNNING = frozenset({JobStatus.RUNNING})

schema = schemathesis.openapi.from_asgi("/openapi.json", APP)
numbers = iter(range(10**9))


def queued() -> str:
    job_id = f"{next(numbers):032x}"
    record = JobRecord(job_id, "local", "block", "0" * 64, JobStatus.QUEUED, created=1.7e9)
    STORE.jobs.create(record, PROBLEM)
    return job_id


def running() -> str:
    job_id = queued()
    STORE.jobs.claim(job_id, "hand")
    return job_id


def solved() -> str:
    job_id = queued()
    record = STORE.jobs.claim(job_id, "hand")
    assert record is not None
    STORE.results.put(job_id, record.token, RESULT)
    STORE.jobs.move(job_id, JobStatus.SUCCEEDED, expect=RUNNING)
    STORE.results.put_report(job_id, record.token, b"<!doctype html>")
    return job_id


def failed() -> str:
    job_id = running()
    STORE.jobs.move(job_id, JobStatus.FAILED, expect=RUNNING)
    return job_id


def sweep() -> str:
    """A sweep of two points, one of which has ended."""
    sweep_id, job_id = f"{next(numbers):032x}", f"{next(numbers):032x}"
    problem = examples.load("block_min_force")
    values = [{"/phases/0/time/final": final} for final in (1, 2)]
    plan = SweepPlan(
        name="block",
        kind="points",
        base=problem,
        points=values,
        chunk=2,
        warm=True,
        seconds=60,
        megabytes=512,
    )
    record = SweepRecord(sweep_id, "local", "block", 1.7e9, total=2, chunk=2, jobs=(job_id,))
    STORE.sweeps.create(record, plan.model_dump_json().encode())
    job = JobRecord(
        job_id,
        "local",
        "block (1/1)",
        "0" * 64,
        JobStatus.QUEUED,
        created=1.7e9,
        kind=JobKind.SWEEP_CHUNK,
        sweep=sweep_id,
        points=2,
    )
    STORE.jobs.create(job, b"{}")
    running = STORE.jobs.claim(job_id, "hand")
    assert running is not None
    ended = PointOutcome(status=PointStatus.SUCCEEDED, solution_status="converged", objective=12.0)
    STORE.sweeps.end(sweep_id, 0, running, ended, RESULT)
    return sweep_id


def ended_sweep() -> str:
    sweep_id = sweep()
    STORE.jobs.move(STORE.sweeps.get(sweep_id).jobs[0], JobStatus.FAILED, expect=RUNNING)
    return sweep_id


SWEEPS = cycle([sweep, ended_sweep, None])
GALLERY = cycle([None, None, *map(examples.load, examples.names())])
SIMULATIONS = cycle([None, *map(examples.load, examples.simulations())])
LIVE, ENDED = cycle([queued, solved, running, solved, failed, None]), cycle([solved, failed, None])


def path_of(context: HookContext) -> str:
    assert context.operation is not None
    return context.operation.path


@schema.hook
def map_path_parameters(context: HookContext, path_parameters: Any) -> Any:
    """Let most ids be those of jobs; streams only of ended ones, or they would not end."""
    if path_parameters and "job_id" in path_parameters:
        make = next(ENDED if path_of(context).endswith("/events") else LIVE)
        if make is not None:
            path_parameters["job_id"] = make()
    if path_parameters and "sweep_id" in path_parameters:
        make = next(SWEEPS)
        if make is not None:
            path_parameters["sweep_id"] = make()
    return path_parameters


@schema.hook
def map_query(context: HookContext, query: Any) -> Any:
    """Do not wait."""
    if query and query.get("wait"):
        query["wait"] = 0
    return query


@schema.hook
def map_body(context: HookContext, body: Any) -> Any:
    """Post good problems too; no generator writes one."""
    if path_of(context) == "/v1/simulations":
        return next(SIMULATIONS) or body
    problem = next(GALLERY)
    if problem and path_of(context) == "/v1/sweeps":
        return {"problem": problem, "grid": {"/phases/0/name": ["one", "two"]}}
    return (problem or body) if path_of(context) == "/v1/jobs" else body


@schema.parametrize()
@settings(
    max_examples=40,
    deadline=None,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)
def test_the_app_keeps_to_its_document(case: Case) -> None:
    case.call_and_validate(checks=CHECKS)
