"""The points of one job: what is kept when attempts are lost, and from where each point starts."""

import time
from dataclasses import replace
from typing import Any

import orjson
import pytest

import examples
import store.memory
from schemas.guesses import SolutionGuess
from schemas.jobs import JobKind, JobStatus
from schemas.problem import Problem
from schemas.results import Solution, SolutionStatus
from schemas.sweeps import ChunkPlan, PointOutcome, PointStatus, SweepPlan
from store.ports import JobRecord, Store, SweepRecord
from tests.support.engines import ENGINES
from tests.support.solutions import block_move
from worker.recovery import Loss, settle
from worker.run import Runner
from worker.settings import WorkerSettings

FINAL = "/phases/0/time/final"
RUNNING = frozenset({JobStatus.RUNNING})


@pytest.fixture
def ports() -> Store:
    return store.memory.connect()


def chunk(ports: Store, points: int = 3, **changes: Any) -> str:
    """A queued chunk with all points of its sweep; the job's id."""
    plan = SweepPlan(
        name="block",
        kind="grid",
        base=examples.load("block_min_force"),
        points=[{FINAL: 1 + index} for index in range(points)],
        chunk=points,
        warm=True,
        seconds=60,
        megabytes=4096,
    ).model_copy(update=changes)
    record = SweepRecord("s1", "ann", "block", time.time(), points, points, ("a1",))
    ports.sweeps.create(record, plan.model_dump_json().encode())
    job = JobRecord(
        id="a1",
        owner="ann",
        name="block",
        spec_sha256="",
        status=JobStatus.QUEUED,
        created=time.time(),
        kind=JobKind.SWEEP_CHUNK,
        sweep="s1",
        points=points,
    )
    body = ChunkPlan(sweep="s1", first=0, end=points).model_dump_json().encode()
    ports.jobs.create(job, body)
    return job.id


class Engine:
    """Notes what it is given, and ends as it is told to: by point, then by attempt."""

    def __init__(self, *statuses: SolutionStatus) -> None:
        self.seen: list[tuple[float, str, float]] = []
        self._statuses = list(statuses)

    def __call__(self, problem: Problem, *, deadline: float | None, **_: Any) -> Solution:
        final = problem.phases[0].time.model_dump(mode="json")["final"]
        assert deadline is not None
        self.seen.append((final, problem.guess.kind, deadline - time.monotonic()))
        status = self._statuses.pop(0) if self._statuses else SolutionStatus.CONVERGED
        return Solution.model_validate(block_move() | {"status": status})


def run(ports: Store, engine: Any, job_id: str = "a1") -> None:
    Runner(ports, ports, replace(ENGINES, solve=engine), "w1").run(job_id)


def guesses(engine: Engine) -> list[str]:
    return [kind for _, kind, _ in engine.seen]


def test_each_point_starts_from_the_one_before(ports: Store) -> None:
    engine = Engine()
    run(ports, engine, chunk(ports))
    assert [final for final, _, _ in engine.seen] == [1, 2, 3]
    assert guesses(engine) == ["points", "solution", "solution"]
    assert ports.jobs.get("a1").status is JobStatus.SUCCEEDED
    ended = ports.sweeps.points("s1").ended
    assert [ended[index].warm for index in range(3)] == [False, True, True]
    assert ended[2].iterations == 3
    assert orjson.loads(ports.sweeps.result("s1", 2) or b"")["status"] == "converged"


def test_a_cold_sweep_starts_each_from_its_own_guess(ports: Store) -> None:
    engine = Engine()
    run(ports, engine, chunk(ports, warm=False))
    assert guesses(engine) == ["points"] * 3


def test_a_warm_start_that_leads_nowhere_is_followed_by_a_cold_one(ports: Store) -> None:
    good, bad = SolutionStatus.CONVERGED, SolutionStatus.LOCALLY_INFEASIBLE
    engine = Engine(good, bad, good, good)
    run(ports, engine, chunk(ports))
    assert guesses(engine) == ["points", "solution", "points", "solution"]
    point = ports.sweeps.points("s1").ended[1]
    assert (point.solution_status, point.warm) == ("converged", False)


def test_a_point_has_the_seconds_of_one_problem(ports: Store) -> None:
    base = examples.load("block_min_force") | {"limits": {"seconds": 5}}
    engine = Engine(SolutionStatus.TIME_LIMIT)
    run(ports, engine, chunk(ports, base=base))
    assert len(engine.seen) == 3  # no second try after a time limit
    assert all(left <= 5 for _, _, left in engine.seen)


def test_the_next_attempt_goes_on_where_the_last_one_was(ports: Store) -> None:
    job_id = chunk(ports)
    lost = ports.jobs.claim(job_id, "w0")
    assert lost is not None
    solved = PointOutcome(status=PointStatus.SUCCEEDED, solution_status="converged")
    ports.sweeps.end("s1", 0, lost, solved, orjson.dumps(block_move()))
    ports.jobs.move(job_id, JobStatus.QUEUED, expect=RUNNING)
    engine = Engine()
    run(ports, engine)
    assert [final for final, _, _ in engine.seen] == [2, 3]
    assert guesses(engine) == ["solution", "solution"]


def test_a_point_that_attempts_are_lost_at_is_given_up(ports: Store) -> None:
    job_id = chunk(ports)
    for _ in range(3):
        lost = ports.jobs.claim(job_id, "w0")
        assert lost is not None
        ports.sweeps.begin("s1", 0, lost)
        settle(ports, lost, Loss(how="signal 9", killed=True), WorkerSettings(url=""))
        assert ports.jobs.get(job_id).status is JobStatus.QUEUED
    run(ports, Engine())
    ended = ports.sweeps.points("s1").ended
    assert [ended[index].status for index in range(3)] == ["failed", "succeeded", "succeeded"]
    assert ended[0].error is not None
    assert ended[0].error.type == "worker-killed"


def test_a_job_of_lost_points_has_an_end(ports: Store) -> None:
    """As many kills as its points may cost together."""
    job_id = chunk(ports)
    for _ in range(6):
        lost = ports.jobs.claim(job_id, "w0")
        assert lost is not None
        settle(ports, lost, Loss(how="signal 9", killed=True), WorkerSettings(url=""))
    assert ports.jobs.get(job_id).status is JobStatus.FAILED


def test_a_stale_attempt_stores_nothing(ports: Store) -> None:
    job_id = chunk(ports)

    def slow(*args: Any, **options: Any) -> Solution:
        ports.jobs.move(job_id, JobStatus.QUEUED, expect=RUNNING)
        ports.jobs.claim(job_id, "w2")
        return Engine()(*args, **options)

    run(ports, slow)
    assert ports.sweeps.points("s1").ended == {}
    assert (ports.jobs.get(job_id).worker, ports.jobs.get(job_id).status) == ("w2", "running")


def test_an_orphan_that_stops_cancels_no_point(ports: Store) -> None:
    """The engine was stopped, but nobody has asked the job to end: another attempt goes on."""
    run(ports, Engine(SolutionStatus.CANCELLED), chunk(ports))
    assert ports.sweeps.points("s1").ended == {}
    assert ports.jobs.get("a1").status is JobStatus.RUNNING


def test_a_sweep_that_is_gone_fails_its_job(ports: Store) -> None:
    job_id = chunk(ports)
    ports.sweeps.delete("s1", "ann")
    run(ports, Engine())
    error = ports.jobs.get(job_id).error
    assert error is not None
    assert error.type == "unknown-sweep"


def test_a_result_without_a_trajectory_makes_no_guess(ports: Store) -> None:
    seen: list[Any] = []

    def engine(problem: Problem, **_: Any) -> Solution:
        seen.append(problem.guess)
        return Solution.model_validate(block_move() | {"phases": []})

    run(ports, engine, chunk(ports))
    assert not any(isinstance(guess, SolutionGuess) for guess in seen)
    assert len(ports.sweeps.points("s1").ended) == 3


def test_nothing_of_a_chunk_is_a_plain_job(ports: Store) -> None:
    job_id = chunk(ports)
    run(ports, Engine())
    record = ports.jobs.get(job_id)
    assert not record.has_result
    assert (ports.results.get(job_id), ports.results.report(job_id)) == (None, None)
