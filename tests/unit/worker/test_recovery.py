"""What becomes of jobs whose attempt was lost, decided over the in-memory store."""

import time
from dataclasses import replace

import pytest

import store.memory
from schemas.jobs import JobStatus
from store.ports import JobRecord, Store
from worker.recovery import Loss, Sweep, settle
from worker.settings import WorkerSettings

SETTINGS = WorkerSettings(url="", ttl=0.05, maintenance=0.02)
KILLED = Loss(how="killed by signal 9", killed=True)


@pytest.fixture
def ports() -> Store:
    return store.memory.connect()


def queued(ports: Store, job_id: str = "a1", seconds: float = 60.0) -> JobRecord:
    record = JobRecord(
        id=job_id,
        owner="ann",
        name="n",
        spec_sha256="",
        status=JobStatus.QUEUED,
        created=time.time(),
        seconds=seconds,
    )
    ports.jobs.create(record, b"{}")
    return record


def claimed(ports: Store, job_id: str = "a1", worker: str = "w1") -> JobRecord:
    record = ports.jobs.claim(job_id, worker)
    assert record is not None
    return record


def test_a_lost_attempt_is_next_in_line(ports: Store) -> None:
    queued(ports)
    ports.queue.enqueue("other")
    settle(ports, claimed(ports), Loss(how="its worker died"), SETTINGS)
    assert ports.jobs.get("a1").status is JobStatus.QUEUED
    assert list(ports.queue.waiting()) == ["a1", "other"]


def test_two_who_settle_queue_it_once(ports: Store) -> None:
    queued(ports)
    record = claimed(ports)
    settle(ports, record, KILLED, SETTINGS)
    settle(ports, record, KILLED, SETTINGS)
    assert list(ports.queue.waiting()) == ["a1"]


def test_kills_and_attempts_have_an_end_but_orders_do_not(ports: Store) -> None:
    queued(ports)
    for _ in range(5):
        settle(ports, claimed(ports), Loss(how="told to end", blameless=True), SETTINGS)
    assert ports.jobs.get("a1").attempts == 5
    settle(ports, claimed(ports), Loss(how="its worker died"), SETTINGS)
    record = ports.jobs.get("a1")
    assert record.status is JobStatus.FAILED
    assert record.error is not None
    assert record.error.type == "worker-killed"


def test_a_process_killed_long_after_its_budget_was_out_of_time(ports: Store) -> None:
    queued(ports, seconds=1.0)
    record = replace(claimed(ports), started=time.time() - 60.0)
    settle(ports, record, KILLED, SETTINGS)
    error = ports.jobs.get("a1").error
    assert error is not None
    assert error.type == "out-of-time"


def test_a_sweep_takes_the_jobs_of_the_dead_and_leaves_those_of_the_living(ports: Store) -> None:
    for job_id, worker in (("a1", "dead"), ("a2", "alive")):
        queued(ports, job_id)
        claimed(ports, job_id, worker)
    ports.queue.announce({"name": "alive"}, ttl=60.0)
    sweep = Sweep(ports, SETTINGS)
    assert sweep.due()
    sweep.run()
    assert not sweep.due()
    assert ports.jobs.get("a1").status is JobStatus.QUEUED
    assert ports.jobs.get("a2").status is JobStatus.RUNNING


def test_nobody_is_dead_right_after_the_server_came_back(ports: Store) -> None:
    queued(ports)
    claimed(ports, worker="dead")
    young = replace(ports, uptime=lambda: 2 * SETTINGS.ttl)
    Sweep(young, SETTINGS).run()
    assert ports.jobs.get("a1").status is JobStatus.RUNNING


def test_nor_after_the_sweep_itself_was_held_up(ports: Store) -> None:
    queued(ports)
    sweep = Sweep(ports, SETTINGS)
    sweep.run()
    claimed(ports, worker="dead")
    time.sleep(SETTINGS.maintenance + SETTINGS.ttl + 0.01)  # the outage
    sweep.run()
    assert ports.jobs.get("a1").status is JobStatus.RUNNING
    end = time.monotonic() + 2 * SETTINGS.ttl
    while time.monotonic() < end:
        sweep.run()
        time.sleep(0.01)
    sweep.run()
    assert ports.jobs.get("a1").status is JobStatus.QUEUED


def test_a_queued_record_in_no_list_is_queued_after_a_while(ports: Store) -> None:
    queued(ports)
    sweep = Sweep(ports, SETTINGS)
    sweep.run()
    assert ports.queue.length() == 0  # it may be on its way
    time.sleep(SETTINGS.ttl)
    sweep.run()
    sweep.run()
    assert list(ports.queue.waiting()) == ["a1"]
