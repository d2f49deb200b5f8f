"""A real worker on a real queue server: the life of a job from its id to its result."""

import json
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import examples
from schemas.errors import QueueFull
from schemas.events import MeshSolved, NlpIteration, StateChanged
from schemas.jobs import JobStatus
from store import connect
from store.ports import Store
from store.settings import StoreSettings
from tests.support.service import ROOT, WorkerProcess, submit, wait_for, wait_until

Start = Callable[..., WorkerProcess]
RUNNING = frozenset({JobStatus.RUNNING})


def test_a_job_goes_through(queue_store: Store, start_worker: Start) -> None:
    worker = start_worker(engine="scripted")
    record = wait_for(queue_store, submit(queue_store, "quick"))
    assert (record.status, record.solution_status) == (JobStatus.SUCCEEDED, "converged")
    assert (record.attempts, record.worker) == (1, worker.name)
    assert record.timings.queued is not None
    result = queue_store.results.get(record.id)
    assert result is not None
    assert json.loads(result)["name"] == "quick"
    wait_until(lambda: queue_store.results.report(record.id) == b"<html>quick</html>")


def test_the_real_engine_moves_a_block(queue_store: Store, start_worker: Start) -> None:
    start_worker()
    job_id = submit(queue_store)
    record = wait_for(queue_store, job_id, seconds=15)
    assert (record.status, record.error) == (JobStatus.SUCCEEDED, None)
    result = json.loads(queue_store.results.get(job_id) or b"{}")
    assert result["objective"] == pytest.approx(12.0, rel=1e-6)  # 12 d^2 / T^3
    assert result["status"] == record.solution_status == "converged"
    assert record.timings.solve is not None
    events = [logged.event for logged in queue_store.events.read(job_id)]
    assert any(isinstance(event, MeshSolved) for event in events)
    assert isinstance(events[-1], StateChanged)
    wait_until(lambda: (queue_store.results.report(job_id) or b"").startswith(b"<!"))


def test_jobs_wait_for_a_worker(queue_store: Store, start_worker: Start) -> None:
    ids = [submit(queue_store, "quick") for _ in range(3)]
    assert queue_store.queue.position(ids[2]) == 2
    start_worker(engine="scripted")
    records = [wait_for(queue_store, job_id) for job_id in ids]
    assert {record.status for record in records} == {JobStatus.SUCCEEDED}
    started = [record.started or 0.0 for record in records]
    assert started == sorted(started)


def test_what_fails_says_why(queue_store: Store, start_worker: Start) -> None:
    start_worker(engine="scripted")
    broken = wait_for(queue_store, submit(queue_store, "broken")).error
    assert broken is not None
    assert (broken.type, broken.message) == ("engine-fault", "RuntimeError: the solver broke")
    senseless = wait_for(queue_store, submit(queue_store, "senseless")).error
    assert senseless is not None
    assert senseless.type == "invalid-model"
    assert senseless.issues[0].pointer == "/phases/0/system"
    assert wait_for(queue_store, submit(queue_store, "quick")).status is JobStatus.SUCCEEDED


def test_a_report_that_fails_loses_no_result(queue_store: Store, start_worker: Start) -> None:
    start_worker(engine="scripted")
    record = wait_for(queue_store, submit(queue_store, "pageless"))
    assert record.status is JobStatus.SUCCEEDED
    assert queue_store.results.get(record.id) is not None
    assert queue_store.results.report(record.id) is None


def test_iterations_are_thinned_and_meshes_are_not(queue_store: Store, start_worker: Start) -> None:
    start_worker(engine="scripted")
    record = wait_for(queue_store, submit(queue_store, "chatty"))
    events = [logged.event for logged in queue_store.events.read(record.id)]
    assert 1 <= len([event for event in events if isinstance(event, NlpIteration)]) <= 10
    assert len([event for event in events if isinstance(event, MeshSolved)]) == 3
    assert record.progress is not None
    assert (record.progress.mesh, record.progress.iteration) == (2, 499)


def cancel(store: Store, job_id: str) -> float:
    """Cancel a running job; the seconds until it has ended."""
    began = time.monotonic()
    assert store.jobs.move(job_id, JobStatus.CANCELLING, expect=RUNNING)
    wait_for(store, job_id)
    return time.monotonic() - began


def test_a_cancelled_solve_keeps_its_iterate(
    queue_store: Store, start_worker: Start, tmp_path: Path
) -> None:
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    job_id = submit(queue_store, "gated")
    wait_for(queue_store, job_id, JobStatus.RUNNING)
    assert cancel(queue_store, job_id) < 1.0
    record = queue_store.jobs.get(job_id)
    assert (record.status, record.solution_status) == (JobStatus.CANCELLED, "cancelled")
    assert queue_store.results.get(job_id) is not None


def test_the_real_engine_stops_with_its_best_iterate(
    queue_store: Store, start_worker: Start
) -> None:
    start_worker()
    long = {
        **examples.load("cart_pole"),
        "method": {"kind": "trapezoidal", "segments": 1500},
        "refinement": {"tolerance": 1e-12, "max_segments": 20_000},  # no mesh is fine enough
    }
    job_id = submit(queue_store, **long)
    wait_until(lambda: _iterations(queue_store, job_id) > 0, 14, "the solve iterates")
    assert cancel(queue_store, job_id) < 2.0
    record = queue_store.jobs.get(job_id)
    assert (record.status, record.solution_status) == (JobStatus.CANCELLED, "cancelled")
    result = json.loads(queue_store.results.get(job_id) or b"{}")
    assert result["phases"]


def _iterations(store: Store, job_id: str) -> int:
    events = [logged.event for logged in store.events.read(job_id)]
    return len([event for event in events if isinstance(event, NlpIteration)])


def test_a_solve_that_does_not_listen_is_killed_and_its_snapshot_kept(
    queue_store: Store, start_worker: Start, tmp_path: Path
) -> None:
    worker = start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    job_id = submit(queue_store, "deaf")
    wait_until(lambda: queue_store.jobs.get(job_id).has_result)
    assert cancel(queue_store, job_id) < 2.0
    record = queue_store.jobs.get(job_id)
    assert (record.status, record.solution_status) == (JobStatus.CANCELLED, "cancelled")
    assert queue_store.results.get(job_id) is not None
    wait_until(lambda: worker.horse() is None)
    assert wait_for(queue_store, submit(queue_store, "quick")).status is JobStatus.SUCCEEDED


def test_a_kill_at_once(queue_store: Store, start_worker: Start, tmp_path: Path) -> None:
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    job_id = submit(queue_store, "deaf")
    wait_until(lambda: queue_store.jobs.get(job_id).has_result)
    assert queue_store.jobs.move(job_id, JobStatus.CANCELLING, expect=RUNNING)
    began = time.monotonic()
    queue_store.queue.stop(job_id)
    assert wait_for(queue_store, job_id).status is JobStatus.CANCELLED
    assert time.monotonic() - began < 0.5


def test_a_deadline_is_kept(queue_store: Store, start_worker: Start, tmp_path: Path) -> None:
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    record = wait_for(queue_store, submit(queue_store, "gated", limits={"seconds": 0.5}))
    assert (record.status, record.solution_status) == (JobStatus.SUCCEEDED, "time_limit")


def test_the_first_sigterm_lets_the_job_end(
    queue_store: Store, start_worker: Start, tmp_path: Path
) -> None:
    worker = start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    job_id = submit(queue_store, "gated")
    wait_for(queue_store, job_id, JobStatus.RUNNING)
    os.kill(worker.pid, signal.SIGTERM)
    (tmp_path / "gate").touch()
    record = wait_for(queue_store, job_id)
    assert (record.status, record.attempts) == (JobStatus.SUCCEEDED, 1)
    assert worker.wait() == 0
    assert queue_store.queue.workers() == []


def test_a_second_sigterm_hands_the_job_back_without_blame(
    queue_store: Store, start_worker: Start, tmp_path: Path
) -> None:
    worker = start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    job_id = submit(queue_store, "gated")
    wait_for(queue_store, job_id, JobStatus.RUNNING)
    os.kill(worker.pid, signal.SIGTERM)
    time.sleep(1.1)  # RQ takes a second signal within a second for the same one
    os.kill(worker.pid, signal.SIGTERM)
    worker.wait()
    record = queue_store.jobs.get(job_id)
    assert (record.status, record.kills) == (JobStatus.QUEUED, 0)
    (tmp_path / "gate").touch()
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    assert wait_for(queue_store, job_id).status is JobStatus.SUCCEEDED


def test_workers_tell_what_they_are(queue_store: Store, start_worker: Start) -> None:
    worker = start_worker(engine="scripted")
    (told,) = queue_store.queue.workers()
    assert (told["name"], told["pid"], told["state"]) == (worker.name, worker.pid, "idle")
    assert isinstance(told["versions"], dict)
    assert "casadi" in told["versions"]


def test_the_health_check_finds_a_live_worker(queue_url: str, start_worker: Start) -> None:
    words = [sys.executable, "-m", "worker", "--check"]
    environment = {**os.environ, "REDIS_URL": queue_url}
    assert subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode == 1
    start_worker(engine="scripted")
    assert subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode == 0
    environment["REDIS_URL"] = "unix:///nowhere"
    assert subprocess.run(words, cwd=ROOT, env=environment, check=False).returncode == 1


def test_an_empty_queue_is_waited_on_quietly(
    queue_store: Store, start_worker: Start, caplog: pytest.LogCaptureFixture
) -> None:
    worker = start_worker(engine="scripted", ttl=1.0)
    time.sleep(2.5)  # longer than its time to live: it must still be told of
    assert [told["name"] for told in queue_store.queue.workers()] == [worker.name]
    assert not [record for record in caplog.records if record.levelno >= logging.WARNING]


def test_a_full_queue_refuses_and_recovers(queue_url: str, start_worker: Start) -> None:
    store = connect(queue_url, settings=StoreSettings(queue_limit=1))
    waiting = submit(store, "quick")
    with pytest.raises(QueueFull):
        submit(store, "quick")
    start_worker(engine="scripted")
    wait_for(store, waiting)
    assert wait_for(store, submit(store, "quick")).status is JobStatus.SUCCEEDED
    store.close()
