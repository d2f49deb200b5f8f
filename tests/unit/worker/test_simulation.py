"""A simulation is a job like any other: the worker's side of that."""

import json
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import store.memory
from schemas.events import Advanced, StageStarted
from schemas.jobs import JobStatus, Progress
from schemas.simulated import SimulationResult
from store.ports import Store
from tests.support.engines import ENGINES, simulated
from tests.support.service import submit_simulation, wait_until
from worker.reporting import Reporter
from worker.run import Runner


@pytest.fixture
def ports() -> Store:
    return store.memory.connect()


def run(ports: Store, job_id: str, simulator: Any = simulated) -> None:
    Runner(ports, ports, replace(ENGINES, simulate=simulator), "w1").run(job_id)


def test_its_result_and_report_are_stored_before_its_end_is_told(ports: Store) -> None:
    job_id = submit_simulation(ports)
    run(ports, job_id)
    record = ports.jobs.get(job_id)
    assert (record.status, record.solution_status) == (JobStatus.SUCCEEDED, "finished")
    assert SimulationResult.model_validate_json(ports.results.get(job_id) or b"").name == "throw"
    assert ports.results.report(job_id) == b"<html>throw</html>"


def test_no_problem_is_solved_for_it(ports: Store) -> None:
    def solve(*_: Any, **__: Any) -> Any:
        raise AssertionError("this is no problem")

    job_id = submit_simulation(ports)
    Runner(ports, ports, replace(ENGINES, solve=solve), "w1").run(job_id)
    assert ports.jobs.get(job_id).status is JobStatus.SUCCEEDED


@pytest.mark.parametrize(
    ("name", "kind"), [("broken", "engine-fault"), ("senseless", "invalid-model")]
)
def test_its_errors_are_those_of_a_solve(ports: Store, name: str, kind: str) -> None:
    job_id = submit_simulation(ports, name)
    run(ports, job_id)
    record = ports.jobs.get(job_id)
    assert record.status is JobStatus.FAILED
    assert record.error is not None
    assert record.error.type == kind


def test_a_cancel_reaches_it_and_keeps_what_there_is(
    ports: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FOOTFALL_TEST_GATE", str(tmp_path / "gate"))
    job_id = submit_simulation(ports, "gated")
    thread = threading.Thread(target=run, args=(ports, job_id))
    thread.start()
    running = frozenset({JobStatus.RUNNING})
    wait_until(lambda: (ports.jobs.get(job_id).progress or Progress()).time == 0.5)
    assert ports.jobs.move(job_id, JobStatus.CANCELLING, expect=running)
    thread.join(10)
    record = ports.jobs.get(job_id)
    assert (record.status, record.solution_status) == (JobStatus.CANCELLED, "cancelled")
    assert json.loads(ports.results.get(job_id) or b"")["status"] == "cancelled"


def test_of_its_steps_the_last_is_told(ports: Store) -> None:
    record = ports.jobs.claim(submit_simulation(ports), "w1")
    assert record is not None
    reporter = Reporter(ports, record)
    reporter(StageStarted(stage="simulate"))
    for step in range(5):
        reporter(Advanced(time=step / 4, end=1.0, events=step))
    reporter.exchange()
    told = [one.event for one in ports.events.read(record.id)]
    assert [one for one in told if isinstance(one, Advanced)] == [
        Advanced(time=1.0, end=1.0, events=4)
    ]
    progress = ports.jobs.get(record.id).progress
    assert progress is not None
    assert (progress.stage, progress.time, progress.end) == ("simulate", 1.0, 1.0)
    reporter(StageStarted(stage="certify"))
    assert reporter.timings().simulate is not None
