"""Workers, their processes and the queue server die at bad moments; no job is lost or doubled."""

import os
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from schemas.jobs import JobStatus
from store import connect
from store.embedded import EmbeddedServer
from store.ports import JobRecord, Store
from store.settings import LONG
from tests.support.service import WorkerProcess, ends, submit, wait_for, wait_until

Start = Callable[..., WorkerProcess]


@pytest.fixture
def gate(tmp_path: Path) -> Path:
    """The engine's ``gated`` problems end once this file exists."""
    return tmp_path / "gate"


def running(store: Store, name: str = "gated") -> str:
    job_id = submit(store, name)
    wait_for(store, job_id, JobStatus.RUNNING)
    return job_id


def attempted(store: Store, job_id: str, attempts: int) -> None:
    wait_until(lambda: store.jobs.get(job_id).attempts == attempts)


def assert_one_result(store: Store, job_id: str, attempts: int) -> JobRecord:
    record = wait_for(store, job_id, seconds=14)
    assert (record.status, record.attempts) == (JobStatus.SUCCEEDED, attempts)
    assert ends(store, job_id) == ["succeeded"]
    assert store.results.get(job_id) is not None
    return record


def test_kill_9_of_the_worker(queue_store: Store, start_worker: Start, gate: Path) -> None:
    first = start_worker(engine="scripted", gate=str(gate))
    job_id = running(queue_store)
    horse = first.horse()
    first.kill()
    wait_until(lambda: not Path(f"/proc/{horse}").exists(), what="the process dies with it")
    start_worker(engine="scripted", gate=str(gate))
    attempted(queue_store, job_id, 2)
    gate.touch()
    assert_one_result(queue_store, job_id, attempts=2)


def test_kill_9_of_the_solving_process(queue_store: Store, start_worker: Start, gate: Path) -> None:
    worker = start_worker(engine="scripted", gate=str(gate))
    job_id = running(queue_store)
    os.kill(worker.horse() or 0, signal.SIGKILL)
    wait_until(lambda: queue_store.jobs.get(job_id).attempts == 2, 2.0)
    gate.touch()
    assert assert_one_result(queue_store, job_id, attempts=2).kills == 1


def test_kill_9_of_both(queue_store: Store, start_worker: Start, gate: Path) -> None:
    first = start_worker(engine="scripted", gate=str(gate))
    second = start_worker(engine="scripted", gate=str(gate))
    job_id = running(queue_store)
    busy, idle = (first, second) if first.horse() else (second, first)
    os.kill(busy.horse() or 0, signal.SIGKILL)
    busy.kill()
    wait_until(lambda: queue_store.jobs.get(job_id).worker == idle.name)
    gate.touch()
    assert_one_result(queue_store, job_id, attempts=queue_store.jobs.get(job_id).attempts)


def test_a_job_that_kills_its_process_is_given_up(queue_store: Store, start_worker: Start) -> None:
    start_worker(engine="scripted")
    record = wait_for(queue_store, submit(queue_store, "deadly"))
    assert (record.status, record.kills) == (JobStatus.FAILED, 2)
    assert record.error is not None
    assert record.error.type == "worker-killed"
    assert "signal 9" in record.error.message
    assert wait_for(queue_store, submit(queue_store, "quick")).status is JobStatus.SUCCEEDED


def test_a_job_that_takes_its_workers_along_is_given_up(
    queue_store: Store, start_worker: Start, gate: Path
) -> None:
    job_id = submit(queue_store, "gated")
    for attempt in (1, 2, 3):
        worker = start_worker(engine="scripted", gate=str(gate), ttl=1.0)
        attempted(queue_store, job_id, attempt)
        worker.kill()
    start_worker(engine="scripted", gate=str(gate), ttl=1.0)
    record = wait_for(queue_store, job_id)
    assert record.status is JobStatus.FAILED
    assert record.error is not None
    assert (record.error.type, "3 attempts" in record.error.message) == ("worker-killed", True)


def test_a_cancelled_job_of_a_dead_worker_ends(
    queue_store: Store, start_worker: Start, gate: Path
) -> None:
    first = start_worker(engine="scripted", gate=str(gate))
    job_id = running(queue_store)
    os.kill(first.pid, signal.SIGSTOP)  # it can neither hear nor enforce
    expect = frozenset({JobStatus.RUNNING})
    os.kill(first.horse() or 0, signal.SIGKILL)
    assert queue_store.jobs.move(job_id, JobStatus.CANCELLING, expect=expect)
    first.kill()
    start_worker(engine="scripted", gate=str(gate))
    assert wait_for(queue_store, job_id).status is JobStatus.CANCELLED
    assert ends(queue_store, job_id) == ["cancelled"]


def test_a_memory_bomb_fails_cleanly(queue_store: Store, start_worker: Start) -> None:
    start_worker(engine="scripted")
    record = wait_for(queue_store, submit(queue_store, "hungry", limits={"megabytes": 256}))
    assert (record.status, record.attempts) == (JobStatus.FAILED, 1)
    assert record.error is not None
    assert record.error.type == "out-of-memory"
    assert "megabytes" in record.error.hint


def test_an_id_delivered_twice_is_solved_once(
    queue_store: Store, start_worker: Start, gate: Path
) -> None:
    job_id = submit(queue_store, "gated")
    queue_store.queue.requeue(job_id)
    queue_store.queue.requeue(job_id)
    start_worker(engine="scripted", gate=str(gate))
    start_worker(engine="scripted", gate=str(gate))
    wait_until(lambda: queue_store.queue.length() == 0)
    gate.touch()
    assert_one_result(queue_store, job_id, attempts=1)


def test_an_id_lost_between_queue_and_worker_is_found(
    queue_store: Store, start_worker: Start
) -> None:
    job_id = submit(queue_store, "quick")
    queue_store.queue.remove(job_id)
    start_worker(engine="scripted", ttl=1.0)
    assert_one_result(queue_store, job_id, attempts=1)


def test_a_worker_that_was_only_asleep_cannot_count_twice(
    queue_store: Store, start_worker: Start, gate: Path
) -> None:
    sleeper = start_worker(engine="scripted", gate=str(gate), ttl=1.0)
    job_id = running(queue_store)
    asleep = [sleeper.pid, sleeper.horse() or 0]
    for pid in asleep:
        os.kill(pid, signal.SIGSTOP)
    start_worker(engine="scripted", gate=str(gate), ttl=1.0)
    attempted(queue_store, job_id, 2)
    gate.touch()
    for pid in asleep:
        os.kill(pid, signal.SIGCONT)
    record = assert_one_result(queue_store, job_id, attempts=2)
    assert record.worker != sleeper.name
    wait_until(lambda: sleeper.horse() is None)
    assert queue_store.jobs.get(job_id) == record


@pytest.fixture
def mortal_server(tmp_path: Path) -> Iterator[EmbeddedServer]:
    """A queue server that a test may kill."""
    with EmbeddedServer(tmp_path / "queue") as server:
        yield server


def test_the_queue_server_is_killed_and_restarted_during_a_solve(
    mortal_server: EmbeddedServer, start_worker: Start, gate: Path
) -> None:
    start_worker(url=mortal_server.url, engine="scripted", gate=str(gate), ttl=1.0)
    store = connect(mortal_server.url, patience=LONG)
    job_id = running(store)
    waiting = submit(store, "quick")
    store.durable()
    os.kill(mortal_server.pid, signal.SIGKILL)
    mortal_server.stop()
    gate.touch()  # the solve ends while there is nobody to tell
    mortal_server.start()
    assert_one_result(store, job_id, attempts=1)
    assert_one_result(store, waiting, attempts=1)
    store.close()


def test_the_queue_server_hangs_for_longer_than_the_time_to_live(
    mortal_server: EmbeddedServer, start_worker: Start, gate: Path
) -> None:
    """All keys of the living have expired when it comes back; nobody may be taken for dead."""
    for _ in range(2):
        start_worker(url=mortal_server.url, engine="scripted", gate=str(gate), ttl=1.0)
    store = connect(mortal_server.url, patience=LONG)
    job_id = running(store)
    wait_until(lambda: store.uptime() > 2.0)
    os.kill(mortal_server.pid, signal.SIGSTOP)
    time.sleep(3.0)  # the outage
    os.kill(mortal_server.pid, signal.SIGCONT)
    time.sleep(1.5)  # long enough for a hasty sweep
    assert Counter(e.event.type for e in store.events.read(job_id))["state"] == 2
    gate.touch()
    assert_one_result(store, job_id, attempts=1)
    store.close()
