"""One job in this process: outcomes, throttled reports, the stop flag, limits, log lines."""

import io
import json
import logging
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest
from rq.timeouts import JobTimeoutException

import store.memory
from schemas.errors import BadProblem, EngineFault, Issue, StoreUnavailable
from schemas.events import MeshSolved, NlpIteration, StageStarted
from schemas.jobs import JobStatus
from schemas.results import SolutionStatus
from store.backend.queue import TASK
from store.embedded import url
from store.ports import JobRecord, Store
from tests.support.engines import ENGINES, scripted, solution
from tests.support.service import ROOT, submit, wait_until
from worker import logs, outcomes, run
from worker.reporting import Reporter
from worker.run import RUNNER, Runner
from worker.settings import server_url


@pytest.fixture
def ports() -> Store:
    return store.memory.connect()


def runner(ports: Store, engine: Any = scripted) -> Runner:
    return Runner(ports, ports, replace(ENGINES, solve=engine), "w1")


def claimed(ports: Store) -> JobRecord:
    record = ports.jobs.claim(submit(ports, "quick"), "w1")
    assert record is not None
    return record


def test_rq_reaches_the_runner_by_name(ports: Store) -> None:
    assert f"{run.perform.__module__}.{run.perform.__qualname__}" == TASK
    job_id = submit(ports, "quick")
    before = RUNNER.set(runner(ports))
    run.perform(job_id)
    RUNNER.reset(before)
    assert ports.jobs.get(job_id).status is JobStatus.SUCCEEDED


def test_a_job_that_is_not_queued_is_passed_over(ports: Store) -> None:
    record = claimed(ports)
    runner(ports).run(record.id)
    assert ports.jobs.get(record.id) == record
    runner(ports).run("unknown")


def test_a_stale_attempt_changes_nothing(ports: Store) -> None:
    """The job is handed on while the engine works."""
    job_id = submit(ports, "quick")

    def slow(*args: Any, **kwargs: Any) -> Any:
        ports.jobs.move(job_id, JobStatus.QUEUED, expect=frozenset({JobStatus.RUNNING}))
        ports.jobs.claim(job_id, "w2")
        return scripted(*args, **kwargs)

    runner(ports, slow).run(job_id)
    record = ports.jobs.get(job_id)
    assert (record.status, record.worker, record.has_result) == (JobStatus.RUNNING, "w2", False)


@pytest.mark.parametrize(
    ("error", "kind", "words"),
    [
        (MemoryError(), "out-of-memory", "memory"),
        (RuntimeError("std::bad_alloc"), "out-of-memory", "memory"),
        (JobTimeoutException("late"), "out-of-time", "limits.seconds"),
        (EngineFault("the solver has no license", "buy one"), "engine-fault", "license"),
        (ZeroDivisionError("a\nb"), "engine-fault", "ZeroDivisionError: a"),
        (ValueError(), "engine-fault", "ValueError"),
        (BadProblem([Issue("/a", "wrong", "mend", 3)]), "bad-problem", "wrong"),
        (BadProblem([]), "bad-problem", "language"),
    ],
)
def test_every_error_has_a_type_and_one_line(error: Exception, kind: str, words: str) -> None:
    outcome = outcomes.failed(error, "a1")
    assert outcome.to is JobStatus.FAILED
    assert outcome.error is not None
    assert outcome.error.type == kind
    assert words in outcome.error.message
    assert "\n" not in outcome.error.message


class Away:
    """A store whose every call finds the server away, until it is back."""

    def __init__(self, real: Any, state: dict[str, bool]) -> None:
        self._real, self._state = real, state

    def __getattr__(self, name: str) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            if self._state["away"]:
                raise StoreUnavailable("away")
            return getattr(self._real, name)(*args, **kwargs)

        return call


@pytest.fixture
def flaky(ports: Store) -> tuple[Store, dict[str, bool]]:
    state = {"away": False}
    jobs, events, results = (
        cast(Any, Away(real, state)) for real in (ports.jobs, ports.events, ports.results)
    )
    return replace(ports, jobs=jobs, events=events, results=results), state


def mesh(number: int) -> MeshSolved:
    return MeshSolved(
        mesh=number,
        segments=5,
        max_error=0.1,
        tolerance=0.1,
        objective=1.0,
        nlp_iterations=3,
        seconds=0.0,
    )


def iteration(number: int) -> NlpIteration:
    return NlpIteration(mesh=0, iteration=number, objective=None, violation=None, seconds=0.0)


def test_what_happened_in_an_outage_is_told_after_it(
    ports: Store, flaky: tuple[Store, dict[str, bool]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every stage and mesh; of each run of iterations the last."""
    monkeypatch.setattr("worker.reporting.PATIENCE", 0.0)
    record = claimed(ports)
    away, state = flaky
    reporter = Reporter(away, record)
    reporter(StageStarted(stage="solve"))
    reporter.exchange()
    state["away"] = True
    for number in range(3):
        reporter(iteration(number))
        reporter.exchange()
    reporter(mesh(0))
    reporter.snapshot(solution("x", SolutionStatus.CANCELLED))
    reporter.exchange()
    assert not ports.jobs.get(record.id).has_result
    state["away"] = False
    reporter(mesh(1))
    reporter.exchange()
    events = [logged.event for logged in ports.events.read(record.id)]
    kinds = [event.type for event in events]
    assert kinds == ["state", "state", "stage", "nlp_iteration", "mesh", "mesh"]
    assert events[3] == iteration(2)
    assert ports.jobs.get(record.id).has_result
    assert not reporter.stop


def test_the_engine_never_waits_for_the_store(ports: Store) -> None:
    """The store hangs; it is talked to from another thread."""
    asked, hangs = threading.Event(), threading.Event()

    class Hanging:
        def append(self, *_: object) -> bool:
            asked.set()
            return hangs.wait(5.0)

    record = claimed(ports)
    reporter = Reporter(replace(ports, events=cast(Any, Hanging())), record)
    with reporter.talking():
        reporter(mesh(0))
        assert asked.wait(2.0)
        began = time.monotonic()
        for number in range(100):
            reporter(iteration(number))
            reporter.snapshot(solution("x", SolutionStatus.CANCELLED))
        assert time.monotonic() - began < 0.1
        hangs.set()


def stored(ports: Store, record: JobRecord) -> str | None:
    """The name in the stored result or snapshot."""
    result = ports.results.get(record.id)
    return None if result is None else json.loads(result)["name"]


def test_a_solve_that_lasts_leaves_snapshots(ports: Store) -> None:
    record = claimed(ports)
    reporter = Reporter(ports, record)
    with reporter.talking():
        reporter.snapshot(solution("first", SolutionStatus.CANCELLED))
        wait_until(lambda: stored(ports, record) == "first", seconds=2.0)
        reporter.snapshot(solution("second", SolutionStatus.CANCELLED))
        wait_until(lambda: stored(ports, record) == "second", seconds=2.0)


def test_a_short_solve_leaves_a_snapshot_where_no_result_follows(ports: Store) -> None:
    record = claimed(ports)
    reporter = Reporter(ports, record)
    reporter.snapshot(solution("snapshot", SolutionStatus.CANCELLED))
    reporter.exchange()
    assert stored(ports, record) is None
    reporter.finish(with_snapshot=False)
    assert stored(ports, record) is None
    reporter.snapshot(solution("snapshot", SolutionStatus.CANCELLED))
    reporter.finish(with_snapshot=True)
    assert stored(ports, record) == "snapshot"


def test_a_cancel_brings_the_snapshot_at_once(ports: Store) -> None:
    """The kill may come next."""
    record = claimed(ports)
    reporter = Reporter(ports, record)
    reporter.snapshot(solution("snapshot", SolutionStatus.CANCELLED))
    ports.jobs.move(record.id, JobStatus.CANCELLING, expect=frozenset({JobStatus.RUNNING}))
    reporter.exchange()
    assert stored(ports, record) == "snapshot"


def test_a_fault_in_telling_does_not_end_the_solve(
    ports: Store, caplog: pytest.LogCaptureFixture
) -> None:
    class Broken:
        def append(self, *_: object) -> str:
            raise MemoryError

    reporter = Reporter(replace(ports, events=cast(Any, Broken())), claimed(ports))
    with reporter.talking():
        reporter(mesh(0))
        wait_until(lambda: "could not be told" in caplog.text)


def test_a_cancel_is_seen_and_an_outage_is_none(
    ports: Store, flaky: tuple[Store, dict[str, bool]]
) -> None:
    record = claimed(ports)
    away, state = flaky
    reporter = Reporter(away, record)
    reporter.exchange()
    state["away"] = True
    reporter.exchange()
    assert not reporter.stop
    state["away"] = False
    ports.jobs.move(record.id, JobStatus.CANCELLING, expect=frozenset({JobStatus.RUNNING}))
    reporter.exchange()
    assert reporter.stop


@pytest.mark.parametrize("fate", ["handed on", "forgotten", "orphaned"])
def test_an_attempt_that_is_not_wanted_stops(
    ports: Store, fate: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = claimed(ports)
    reporter = Reporter(ports, record)
    running = frozenset({JobStatus.RUNNING})
    if fate == "orphaned":
        monkeypatch.setattr("os.getppid", lambda: 1)
    elif fate == "handed on":
        ports.jobs.move(record.id, JobStatus.QUEUED, expect=running)
    else:
        ports.jobs.move(record.id, JobStatus.FAILED, expect=running)
        ports.jobs.delete(record.id, record.owner)
    reporter.exchange()
    assert reporter.stop


def test_timings_add_up_by_stage(ports: Store) -> None:
    reporter = Reporter(ports, claimed(ports))
    for stage in ("build", "solve", "refine", "solve"):
        reporter(StageStarted(stage=stage))
        time.sleep(0.01)
    timings = reporter.timings()
    assert timings.build is not None
    assert timings.solve is not None
    assert timings.solve > 0.015 > timings.build
    assert timings.certify is None


BOMB = """
from worker import limits
with limits.memory(64):
    try:
        bytearray(200 << 20)
    except MemoryError:
        print("refused")
print(len(bytearray(200 << 20)))
"""


def test_memory_has_a_limit_inside_and_none_after() -> None:
    ran = subprocess.run([sys.executable, "-c", BOMB], cwd=ROOT, capture_output=True, check=True)
    assert ran.stdout.split() == [b"refused", str(200 << 20).encode()]


def test_an_orphan_ends_at_once() -> None:
    words = "from worker import limits; limits.die_with(1); print('alive')"
    ran = subprocess.run([sys.executable, "-c", words], cwd=ROOT, capture_output=True, check=False)
    assert (ran.returncode, ran.stdout) == (1, b"")


@pytest.fixture
def logged() -> Iterator[tuple[logging.Logger, logging.StreamHandler[io.StringIO]]]:
    handler = logging.StreamHandler(io.StringIO())
    logger = logging.getLogger("test.worker.logs")
    logger.addHandler(handler)
    logger.propagate = False
    yield logger, handler
    logger.removeHandler(handler)


@pytest.mark.parametrize("formatter", [logs.TextLine(), logs.JsonLine()])
def test_an_event_is_one_line_whatever_users_write(
    logged: tuple[logging.Logger, logging.StreamHandler[io.StringIO]], formatter: logging.Formatter
) -> None:
    logger, handler = logged
    handler.setFormatter(formatter)
    try:
        int("two\nlines")
    except ValueError:
        logger.exception("job %s", "a\r\nERROR forged\x1b[31m\u2028x")
    text = handler.stream.getvalue()
    assert len(text.splitlines()) == 1
    assert "\x1b" not in text
    assert "Traceback" in text


def test_json_lines_are_json(
    logged: tuple[logging.Logger, logging.StreamHandler[io.StringIO]],
) -> None:
    logger, handler = logged
    handler.setFormatter(logs.JsonLine())
    logger.warning("words %d", 1)
    told = json.loads(handler.stream.getvalue())
    assert (told["message"], told["level"]) == ("words 1", "WARNING")


def test_the_server_comes_from_the_environment_of_the_moment() -> None:
    assert server_url({"REDIS_URL": "redis://there"}) == "redis://there"
    assert server_url({"FOOTFALL_DATA": "elsewhere"}) == url(Path("elsewhere"))
    assert server_url({}) == url(Path(".footfall"))
