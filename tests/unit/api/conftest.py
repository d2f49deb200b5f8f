"""An app over a store in memory, and a hand that plays the worker."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import orjson
import pytest
from fastapi import FastAPI

from api.app import create_app
from api.settings import ApiSettings
from schemas.events import NlpIteration
from schemas.jobs import JobError, JobStatus, JobTimings, Progress
from store.memory import connect
from store.ports import JobRecord, Store
from tests.support.asgi import AppClient, app_client
from tests.support.solutions import block_move

LIVE = frozenset({JobStatus.RUNNING, JobStatus.CANCELLING})


@dataclass(frozen=True)
class Hand:
    """Plays the worker, one step at a time."""

    store: Store

    def start(self, job_id: str) -> JobRecord:
        self.store.queue.remove(job_id)
        record = self.store.jobs.claim(job_id, "hand")
        assert record is not None
        return record

    def iterate(self, record: JobRecord, iteration: int) -> None:
        event = NlpIteration(mesh=0, iteration=iteration, objective=1.5, violation=0.1, seconds=0.2)
        progress = Progress(stage="solve", segments=10, iteration=iteration, objective=1.5)
        self.store.jobs.update(record.id, record.token, progress, JobTimings(queued=0.1))
        self.store.events.append(record.id, [event], record.token)

    def end(
        self,
        record: JobRecord,
        to: JobStatus = JobStatus.SUCCEEDED,
        *,
        result: dict[str, Any] | None = None,
        report: bytes | None = None,
        error: JobError | None = None,
    ) -> None:
        if result is not None:
            self.store.results.put(record.id, record.token, orjson.dumps(result))
        status = result["status"] if result else None
        moved = self.store.jobs.move(
            record.id, to, expect=LIVE, token=record.token, solution_status=status, error=error
        )
        assert moved is not None
        if report is not None:
            self.store.results.put_report(record.id, record.token, report)

    def solve(self, job_id: str, report: bytes | None = None) -> dict[str, Any]:
        result = block_move()
        self.end(self.start(job_id), result=result, report=report)
        return result


@pytest.fixture
def settings() -> ApiSettings:
    return ApiSettings(stop_grace=0.02)


@pytest.fixture
def store() -> Store:
    return connect()


@pytest.fixture
def hand(store: Store) -> Hand:
    return Hand(store)


@pytest.fixture
def app(store: Store, settings: ApiSettings) -> FastAPI:
    return create_app(store, settings)


@pytest.fixture
def client(app: FastAPI) -> Iterator[AppClient]:
    with app_client(app) as client:
        yield client
