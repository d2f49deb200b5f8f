"""A real queue server and real workers for tests, and waiting without guessed sleeps."""

import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import Any, TypeVar

import pytest

from schemas.events import StateChanged
from schemas.jobs import TERMINAL, JobKind, JobStatus
from schemas.problem import Problem
from schemas.reading import canonical, read_problem
from schemas.simulations import Simulation, read_simulation
from store import connect
from store.backend.connection import open_client
from store.embedded import EmbeddedServer
from store.ports import JobRecord, Store
from store.settings import SHORT

ROOT = Path(__file__).parents[2]
T = TypeVar("T")

# A block of 1 kg moves 1 m in 1 s at rest to rest: the smallest problem there is.
BLOCK: dict[str, Any] = {
    "name": "block",
    "phases": [
        {
            "name": "move",
            "system": {
                "kind": "ode",
                "states": ["x", "v"],
                "controls": ["u"],
                "derivatives": {"x": "v", "v": "u"},
            },
            "time": {"initial": 0, "final": 1},
            "initial": {"x": 0, "v": 0},
            "final": {"x": 1, "v": 0},
            "integrals": {"effort": "u^2"},
        }
    ],
    "objective": {"minimize": "effort"},
    "method": {"kind": "hermite_simpson", "segments": 10},
}


# The same block, thrown: the smallest simulation.
THROW: dict[str, Any] = {
    "name": "throw",
    "system": {
        "kind": "ode",
        "states": ["y", "v"],
        "derivatives": {"y": "v", "v": "-9.81"},
    },
    "initial": {"v": 9.81},
    "duration": 1.5,
}


def wait_until(look: Callable[[], T | None], seconds: float = 10.0, what: str = "") -> T:
    """What ``look`` gives as soon as it is true; fails after so many seconds."""
    end = time.monotonic() + seconds
    while True:
        seen = look()
        if seen:
            return seen
        assert time.monotonic() < end, f"not within {seconds} s: {what or look}"
        time.sleep(0.02)


def submit(store: Store, name: str = "block", owner: str = "local", **changes: Any) -> str:
    """Store and queue the block under a name (the scripted engine acts by it); the job's id."""
    problem = read_problem({**BLOCK, "name": name, **changes})
    return _queue(store, problem, owner, JobKind.SOLVE)


def submit_simulation(store: Store, name: str = "throw", **changes: Any) -> str:
    """Store and queue the throw under a name; the job's id."""
    simulation = read_simulation({**THROW, "name": name, **changes})
    return _queue(store, simulation, "local", JobKind.SIMULATION)


def _queue(store: Store, document: Problem | Simulation, owner: str, kind: JobKind) -> str:
    record = JobRecord(
        id=uuid.uuid4().hex,
        owner=owner,
        name=document.name,
        spec_sha256="0" * 64,
        status=JobStatus.QUEUED,
        created=time.time(),
        seconds=document.limits.seconds,
        megabytes=document.limits.megabytes,
        kind=kind,
    )
    store.jobs.create(record, canonical(document))
    store.queue.enqueue(record.id)
    store.durable()
    return record.id


def wait_for(store: Store, job_id: str, *states: JobStatus, seconds: float = 10.0) -> JobRecord:
    """The record once its job is in one of the states (by default: has ended)."""
    wanted = set(states) or set(TERMINAL)

    def look() -> JobRecord | None:
        record = store.jobs.get(job_id)
        return record if record.status in wanted else None

    return wait_until(look, seconds, f"{job_id} in {sorted(wanted)}")


def ends(store: Store, job_id: str) -> list[str]:
    """The states that the log says the job ended in; one if all is well."""
    return [
        logged.event.status
        for logged in store.events.read(job_id)
        if isinstance(logged.event, StateChanged) and logged.event.terminal
    ]


class WorkerProcess:
    """A worker in a process of its own. ``engine`` is ``module:function``; empty: the real one."""

    def __init__(self, url: str, *, engine: str = "", ttl: float = 1.5, gate: str = "") -> None:
        self._words = [sys.executable, "-m", "tests.support.worker_process", url, str(ttl), engine]
        self._environment = {**os.environ, "FOOTFALL_TEST_GATE": gate}
        self._url = url
        self.name = f"test-{uuid.uuid4().hex[:8]}"
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> "WorkerProcess":
        """Start; returns once it has told that it lives."""
        self.process = subprocess.Popen(
            [*self._words, self.name], cwd=ROOT, env=self._environment, start_new_session=True
        )
        with closing(connect(self._url)) as store:
            wait_until(lambda: self.name in {w["name"] for w in store.queue.workers()}, 20)
        return self

    @property
    def pid(self) -> int:
        """The worker's own process, not that of a job."""
        assert self.process is not None
        return self.process.pid

    def horse(self) -> int | None:
        """The process of the running job."""
        children = Path(f"/proc/{self.pid}/task/{self.pid}/children")
        with suppress(FileNotFoundError):
            return next((int(pid) for pid in children.read_text().split()), None)
        return None

    def kill(self) -> None:
        """SIGKILL, as the kernel or a crashed machine would."""
        os.kill(self.pid, signal.SIGKILL)
        self.wait()

    def wait(self, seconds: float = 10.0) -> int:
        """Wait for its end; the exit code."""
        assert self.process is not None
        return self.process.wait(seconds)

    def stop(self) -> None:
        """End it in order, or by force."""
        if self.process is None or self.process.poll() is not None:
            return
        self.process.terminate()
        try:
            self.process.wait(3)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


@pytest.fixture(scope="session")
def shared_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmbeddedServer]:
    """One embedded queue server for all tests that do not hurt it."""
    with EmbeddedServer(tmp_path_factory.mktemp("queue")) as server:
        yield server


@pytest.fixture
def queue_url(shared_server: EmbeddedServer) -> str:
    """The URL of an empty queue server."""
    with closing(open_client(shared_server.url, SHORT)) as client:
        client.flushall()
    return shared_server.url


@pytest.fixture
def queue_store(queue_url: str) -> Iterator[Store]:
    """A store over an empty queue server."""
    store = connect(queue_url)
    yield store
    store.close()


@pytest.fixture
def start_worker(queue_url: str) -> Iterator[Callable[..., WorkerProcess]]:
    """Starts workers on that server and stops them after the test."""
    started: list[WorkerProcess] = []

    def start(url: str = queue_url, **options: Any) -> WorkerProcess:
        worker = WorkerProcess(url, **options)
        started.append(worker)
        return worker.start()

    yield start
    for worker in started:
        worker.stop()
