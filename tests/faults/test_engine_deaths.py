"""The same with the engine itself: what is killed is a process inside IPOPT, on a real problem."""

import json
import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import examples
from schemas.events import NlpIteration, StageStarted
from schemas.jobs import JobStatus
from store import connect
from store.embedded import EmbeddedServer
from store.ports import JobRecord, Store
from store.settings import LONG
from tests.support.service import WorkerProcess, ends, submit, wait_for, wait_until

Start = Callable[..., WorkerProcess]


def slow(segments: int = 1000, tolerance: float = 1e-12) -> dict[str, Any]:
    """The cart-pole on a fine mesh, for seconds inside IPOPT."""
    return examples.load("cart_pole") | {
        "refinement": None,
        "method": {"kind": "hermite_simpson", "segments": segments},
        "solver": {"tolerance": tolerance},
    }


def inside_ipopt(store: Store) -> str:
    job_id = submit(store, **slow())
    wait_until(lambda: iterations(store, job_id) > 0 or ends(store, job_id), 15)
    assert not ends(store, job_id)
    return job_id


def iterations(store: Store, job_id: str) -> int:
    events = [logged.event for logged in store.events.read(job_id)]
    return len([event for event in events if isinstance(event, NlpIteration)])


def assert_solved_once(store: Store, job_id: str, attempts: int) -> JobRecord:
    record = wait_for(store, job_id, seconds=14)
    assert (record.status, record.attempts) == (JobStatus.SUCCEEDED, attempts)
    assert ends(store, job_id) == ["succeeded"]
    result = json.loads(store.results.get(job_id) or b"{}")
    assert result["objective"] == pytest.approx(58.80767, abs=1e-3)
    return record


def test_kill_9_inside_ipopt(queue_store: Store, start_worker: Start) -> None:
    worker = start_worker()
    job_id = inside_ipopt(queue_store)
    os.kill(worker.horse() or 0, signal.SIGKILL)
    assert assert_solved_once(queue_store, job_id, attempts=2).kills == 1


def test_kill_9_of_a_worker_whose_process_is_inside_ipopt(
    queue_store: Store, start_worker: Start
) -> None:
    first = start_worker(ttl=1.0)
    job_id = inside_ipopt(queue_store)
    horse = first.horse()
    first.kill()
    wait_until(lambda: gone(horse or 0), what="native code dies with its worker")
    second = start_worker(ttl=1.0)
    assert assert_solved_once(queue_store, job_id, attempts=2).worker == second.name


def gone(pid: int) -> bool:
    """Whether a process has ended, though perhaps nobody has asked for its exit code yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


@pytest.fixture
def mortal_server(tmp_path: Path) -> Iterator[EmbeddedServer]:
    """A queue server that a test may kill."""
    with EmbeddedServer(tmp_path / "queue") as server:
        yield server


def test_the_queue_server_is_killed_while_ipopt_runs(
    mortal_server: EmbeddedServer, start_worker: Start
) -> None:
    start_worker(url=mortal_server.url, ttl=1.0)
    store = connect(mortal_server.url, patience=LONG)
    job_id, waiting = inside_ipopt(store), submit(store)
    os.kill(mortal_server.pid, signal.SIGKILL)
    wait_until(lambda: not mortal_server.running)
    mortal_server.start()
    assert_solved_once(store, job_id, attempts=1)
    assert wait_for(store, waiting).status is JobStatus.SUCCEEDED
    store.close()


@pytest.mark.parametrize(("stage", "segments"), [("build", 5000), ("certify", 3000)])
def test_a_cancel_where_nobody_listens(
    queue_store: Store, start_worker: Start, stage: str, segments: int
) -> None:
    """What does not hear is killed after a second; what was kept until then says what it is."""
    start_worker()
    job_id = submit(queue_store, **slow(segments, 1e-6))
    wait_until(lambda: stage in stages(queue_store, job_id), 20, f"it reaches {stage}")
    began = time.monotonic()
    assert queue_store.jobs.move(
        job_id, JobStatus.CANCELLING, expect=frozenset({JobStatus.RUNNING})
    )
    record = wait_for(queue_store, job_id)
    assert time.monotonic() - began < 2.0
    assert record.status is JobStatus.CANCELLED
    kept = json.loads(queue_store.results.get(job_id) or b"{}")
    assert kept.get("status") == record.solution_status
    assert record.solution_status in ({"cancelled"} if stage == "certify" else {"cancelled", None})


def stages(store: Store, job_id: str) -> list[str]:
    events = [logged.event for logged in store.events.read(job_id)]
    return [event.stage for event in events if isinstance(event, StageStarted)]
