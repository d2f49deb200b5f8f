"""One set of tests for every store: what the ports promise holds in memory and on a server."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from typing import cast

import pytest

import store.memory
from schemas.errors import BadProblem, Conflict, QueueFull, UnknownJob
from schemas.events import NlpIteration, StageStarted, StateChanged
from schemas.jobs import JobError, JobKind, JobStatus, JobTimings, Progress
from store import connect
from store.ports import KEY_IN_FLIGHT, KEY_REUSED, JobRecord, LoggedEvent, Store
from store.settings import StoreSettings
from tests.support.service import wait_until

Make = Callable[[StoreSettings], Store]
QUEUED = frozenset({JobStatus.QUEUED})
RUNNING = frozenset({JobStatus.RUNNING})


@pytest.fixture(params=["memory", "server"])
def make(request: pytest.FixtureRequest) -> Iterator[Make]:
    """Makes stores of one kind."""
    if request.param == "memory":
        yield store.memory.connect
        return
    url = request.getfixturevalue("queue_url")
    made: list[Store] = []

    def connected(settings: StoreSettings) -> Store:
        made.append(connect(url, settings=settings))
        return made[-1]

    yield connected
    for one in made:
        one.close()


@pytest.fixture
def ports(make: Make) -> Store:
    return make(StoreSettings(queue_limit=3, events_limit=1000))


def add(ports: Store, job_id: str = "a1", **changes: object) -> JobRecord:
    record = JobRecord(
        id=job_id, owner="ann", name="n", spec_sha256="f", status=JobStatus.QUEUED, created=100.5
    )
    record = replace(record, **changes)  # type: ignore[arg-type]
    ports.jobs.create(record, b'{"name": "n"}')
    return record


def run(ports: Store, job_id: str = "a1") -> JobRecord:
    claimed = ports.jobs.claim(job_id, "w1")
    assert claimed is not None
    return claimed


def end(ports: Store, job_id: str = "a1", to: JobStatus = JobStatus.SUCCEEDED) -> JobRecord:
    moved = ports.jobs.move(job_id, to, expect=RUNNING)
    assert moved is not None
    return moved


def statuses(events: list[LoggedEvent]) -> list[str]:
    return [each.event.status for each in events if isinstance(each.event, StateChanged)]


def test_a_record_comes_back_as_it_was_stored(ports: Store) -> None:
    record = add(ports, seconds=12.25, megabytes=512, name="Schöne Größe \"'\n")
    assert ports.jobs.get("a1") == record
    assert ports.jobs.get("a1", "ann") == record
    assert ports.jobs.problem("a1") == b'{"name": "n"}'


def test_a_foreign_or_unknown_job_is_unknown(ports: Store) -> None:
    add(ports)
    for job_id, owner in (("a1", "bob"), ("zz", "ann"), ("zz", None)):
        with pytest.raises(UnknownJob):
            ports.jobs.get(job_id, owner)
    with pytest.raises(UnknownJob):
        ports.jobs.problem("zz")
    with pytest.raises(UnknownJob):
        ports.jobs.delete("a1", "bob")


def test_a_claim_is_granted_once(ports: Store) -> None:
    add(ports)
    claimed = run(ports)
    assert (claimed.status, claimed.attempts, claimed.worker) == (JobStatus.RUNNING, 1, "w1")
    assert claimed.token
    assert claimed.started is not None
    assert ports.jobs.claim("a1", "w2") is None
    assert ports.jobs.claim("zz", "w2") is None


def test_a_move_needs_the_expected_state_and_the_live_token(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    stale = token[::-1]
    assert ports.jobs.move("a1", JobStatus.CANCELLED, expect=QUEUED) is None
    assert ports.jobs.move("a1", JobStatus.SUCCEEDED, expect=RUNNING, token=stale) is None
    error = JobError(type="engine-fault", message="no\nluck", hint="try")
    moved = ports.jobs.move(
        "a1",
        JobStatus.FAILED,
        expect=RUNNING,
        token=token,
        error=error,
        message="no luck",
        timings=JobTimings(solve=1.5),
    )
    assert moved is not None
    assert (moved.error, moved.message, moved.timings.solve) == (error, "no luck", 1.5)
    assert moved.finished is not None
    assert moved == ports.jobs.get("a1")


def test_a_move_may_be_repeated_by_who_holds_the_token(ports: Store) -> None:
    """The reply of the first may have been lost with the connection."""
    add(ports)
    token = run(ports).token
    for _ in range(2):
        moved = ports.jobs.move("a1", JobStatus.SUCCEEDED, expect=RUNNING, token=token)
        assert moved is not None
    assert statuses(ports.events.read("a1")) == ["queued", "running", "succeeded"]


def test_a_move_that_does_not_exist_is_a_bug(ports: Store) -> None:
    add(ports)
    with pytest.raises(ValueError, match="no move leads"):
        ports.jobs.move("a1", JobStatus.SUCCEEDED, expect=QUEUED)


def test_many_movers_one_wins(ports: Store) -> None:
    add(ports)
    run(ports)
    wins: list[JobRecord | None] = []

    def race() -> None:
        wins.append(ports.jobs.move("a1", JobStatus.CANCELLING, expect=RUNNING))

    threads = [threading.Thread(target=race) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len([win for win in wins if win]) == 1
    assert statuses(ports.events.read("a1")).count("cancelling") == 1


def test_a_lost_attempt_goes_back_and_its_token_is_dead(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    back = ports.jobs.move("a1", JobStatus.QUEUED, expect=RUNNING, token=token, killed=True)
    assert back is not None
    assert (back.status, back.kills, back.attempts) == (JobStatus.QUEUED, 1, 1)
    again = run(ports)
    assert again.attempts == 2
    assert again.token != token
    assert not ports.results.put("a1", token, b"old")
    assert not ports.jobs.update("a1", token, Progress(iteration=1), JobTimings())
    assert not ports.events.append("a1", [StateChanged(status="x", terminal=False)], token)
    assert ports.jobs.move("a1", JobStatus.SUCCEEDED, expect=RUNNING, token=token) is None


def test_progress_is_kept(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    progress = Progress(stage="solve", iteration=7, objective=1e-17)
    assert ports.jobs.update("a1", token, progress, JobTimings(build=0.1))
    record = ports.jobs.get("a1")
    assert (record.progress, record.timings.build) == (progress, 0.1)


def test_an_update_says_whether_to_go_on(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    last = Progress(stage="solve", iteration=8)
    assert ports.jobs.move("a1", JobStatus.CANCELLING, expect=RUNNING)
    assert not ports.jobs.update("a1", token, last, JobTimings())
    assert ports.jobs.get("a1").progress == last
    assert ports.jobs.move("a1", JobStatus.CANCELLED, expect=frozenset({JobStatus.CANCELLING}))
    assert not ports.jobs.update("a1", token, Progress(iteration=9), JobTimings())
    assert ports.jobs.get("a1").progress == last
    assert not ports.jobs.update("forgotten", token, last, JobTimings())


def test_events_come_in_order_and_none_after_the_end(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    stages = [StageStarted(stage="build"), StageStarted(stage="solve")]
    assert ports.events.append("a1", stages, token)
    end(ports)
    assert not ports.events.append("a1", stages, token)
    events = [logged.event for logged in ports.events.read("a1")]
    assert events[2:4] == stages
    assert statuses(ports.events.read("a1"))[-1] == "succeeded"
    assert len(events) == 5


def test_results_need_a_live_attempt(ports: Store) -> None:
    add(ports)
    assert not ports.results.put("a1", "", b"{}")
    token = run(ports).token
    assert ports.results.get("a1") is None
    assert ports.results.put("a1", token, b"so far")
    assert ports.jobs.get("a1").has_result
    assert ports.results.get("a1") == b"so far"
    assert ports.results.put("a1", token, b"all")
    end(ports)
    assert not ports.results.put("a1", token, b"too late")
    assert ports.results.get("a1") == b"all"


def test_a_report_comes_after_the_end_and_goes_with_the_result(make: Make) -> None:
    ports = make(StoreSettings(retention=1.0))
    add(ports)
    token = run(ports).token
    ports.results.put("a1", token, b"{}")
    assert not ports.results.put_report("a1", token, b"too early")
    end(ports)
    assert not ports.results.put_report("a1", "another", b"foreign")
    assert ports.results.report("a1") is None
    assert ports.results.put_report("a1", token, b"<html>")
    assert ports.results.report("a1") == b"<html>"
    wait_until(lambda: ports.jobs.get("a1").status is JobStatus.EXPIRED)
    wait_until(lambda: ports.results.report("a1") is None)
    assert not ports.results.put_report("a1", token, b"too late")


def test_a_report_needs_a_result(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    end(ports, to=JobStatus.FAILED)
    assert not ports.results.put_report("a1", token, b"<html>")
    assert not ports.results.put_report("unknown", "", b"<html>")


def test_a_result_has_its_time(make: Make) -> None:
    ports = make(StoreSettings(retention=1.0))
    add(ports)
    ports.results.put("a1", run(ports).token, b"{}")
    end(ports)
    add(ports, "b2")
    run(ports, "b2")
    end(ports, "b2", JobStatus.FAILED)
    assert ports.jobs.get("a1").status is JobStatus.SUCCEEDED
    wait_until(lambda: ports.jobs.get("a1").status is JobStatus.EXPIRED)
    wait_until(lambda: ports.results.get("a1") is None)
    assert ports.jobs.list("ann", status=JobStatus.EXPIRED).records[0].id == "a1"
    assert ports.jobs.get("b2").status is JobStatus.FAILED  # there was nothing to expire
    last = list(ports.events.follow("a1"))[-1]
    assert last is not None
    assert isinstance(last.event, StateChanged)
    assert last.event.terminal


def test_listing_is_newest_first_and_pages(ports: Store) -> None:
    for number in range(7):
        add(ports, f"j{number}", created=float(number // 2))  # some of the same instant
    add(ports, "other", owner="bob")
    seen: list[str] = []
    cursor: str | None = None
    while True:
        page = ports.jobs.list("ann", cursor=cursor, limit=2)
        seen += [record.id for record in page.records]
        cursor = page.next
        if cursor is None:
            break
    assert seen == ["j6", "j5", "j4", "j3", "j2", "j1", "j0"]


def test_listing_filters(ports: Store) -> None:
    add(ports, "a1", name="one", created=1.0)
    add(ports, "a2", name="two", created=2.0)
    run(ports, "a1")
    assert [r.id for r in ports.jobs.list("ann", status=JobStatus.RUNNING).records] == ["a1"]
    assert [r.id for r in ports.jobs.list("ann", name="two").records] == ["a2"]
    assert ports.jobs.list("nobody").records == []


def test_listing_has_solves_and_simulations_but_no_chunks(ports: Store) -> None:
    for number, kind in enumerate(JobKind):
        add(ports, f"j{number}", kind=kind, created=float(number))
    listed = {record.kind for record in ports.jobs.list("ann").records}
    assert listed == {JobKind.SOLVE, JobKind.SIMULATION}
    for kind in listed:
        assert [r.kind for r in ports.jobs.list("ann", kind=kind).records] == [kind]


@pytest.mark.parametrize("cursor", ["x", "!!!", "é", "bmFuIGE", "MSAyIDM"])
def test_a_made_up_cursor_is_refused(ports: Store, cursor: str) -> None:
    with pytest.raises(BadProblem, match="cursor"):
        ports.jobs.list("ann", cursor=cursor)


def test_live_jobs_are_those_that_have_not_ended(ports: Store) -> None:
    for job_id in ("a1", "a2", "a3"):
        add(ports, job_id)
    run(ports, "a1")
    run(ports, "a2")
    end(ports, "a2")
    assert {record.id for record in ports.jobs.live()} == {"a1", "a3"}


def test_only_an_ended_job_is_forgotten_and_then_wholly(ports: Store) -> None:
    add(ports)
    with pytest.raises(Conflict):
        ports.jobs.delete("a1", "ann")
    token = run(ports).token
    ports.results.put("a1", token, b"{}")
    end(ports)
    ports.results.put_report("a1", token, b"<html>")
    ports.jobs.delete("a1", "ann")
    with pytest.raises(UnknownJob):
        ports.jobs.get("a1")
    assert not ports.results.put_report("a1", token, b"<html>")
    assert (ports.results.get("a1"), ports.results.report("a1")) == (None, None)
    assert ports.events.read("a1") == []
    assert ports.jobs.list("ann").records == []
    assert list(ports.events.follow("a1", timeout=0.1)) == []
    assert not ports.events.append("a1", [StateChanged(status="x", terminal=False)], token)


def test_every_move_is_in_the_log(ports: Store) -> None:
    add(ports)
    run(ports)
    end(ports)
    logged = ports.events.read("a1")
    assert statuses(logged) == ["queued", "running", "succeeded"]
    last = cast(StateChanged, logged[-1].event)
    assert (last.terminal, last.attempt) == (True, 1)
    assert ports.events.read("a1", logged[0].id) == logged[1:]
    assert ports.events.read("a1", "not an id") == logged


def test_a_follower_sees_what_comes_and_ends_with_the_job(ports: Store) -> None:
    add(ports)
    token = run(ports).token
    with closing(ports.events.follow("a1", timeout=20.0)) as stream:  # type: ignore[type-var]
        assert [next(stream), next(stream)] == ports.events.read("a1")
        event = NlpIteration(mesh=0, iteration=1, objective=1.0, violation=None, seconds=0.1)

        def work() -> None:
            ports.events.append("a1", [event], token)
            end(ports)

        later = threading.Timer(0.2, work)
        later.start()
        began = time.monotonic()
        following = [logged.event for logged in stream if logged]
        assert time.monotonic() - began < 1.5  # woken, not polled
        later.join()
    assert following[0] == event
    assert isinstance(following[1], StateChanged)
    assert len(following) == 2


def test_silence_is_told(ports: Store) -> None:
    add(ports)
    with closing(ports.events.follow("a1", "999999999999999", timeout=0.05)) as stream:  # type: ignore[type-var]
        assert next(stream) is None
        assert next(stream) is None


def test_after_the_end_the_terminal_event_comes_again(ports: Store) -> None:
    add(ports)
    run(ports)
    end(ports)
    last = ports.events.read("a1")[-1]
    assert list(ports.events.follow("a1", last.id)) == [last]
    assert list(ports.events.follow("a1", "no-id"))[-1] == last


def test_the_log_is_capped_and_keeps_its_end(make: Make) -> None:
    ports = make(StoreSettings(events_limit=100))
    add(ports)
    token = run(ports).token
    for iteration in range(600):
        event = NlpIteration(
            mesh=0, iteration=iteration, objective=None, violation=None, seconds=0.0
        )
        ports.events.append("a1", [event], token)
    end(ports)
    logged = ports.events.read("a1")
    assert len(logged) <= 300  # the server trims in whole nodes
    assert statuses(logged) == ["succeeded"]


def test_the_queue_is_first_in_first_out_and_has_an_end(ports: Store) -> None:
    for job_id in ("a1", "a2", "a3", "a4"):
        add(ports, job_id)
    for job_id in ("a1", "a2", "a3"):
        ports.queue.enqueue(job_id)
    with pytest.raises(QueueFull):
        ports.queue.enqueue("a4")
    assert list(ports.queue.waiting()) == ["a1", "a2", "a3"]
    assert [ports.queue.position(job_id) for job_id in ("a1", "a3", "a4")] == [0, 2, None]
    ports.queue.remove("a2")
    ports.queue.requeue("a4")
    assert list(ports.queue.waiting()) == ["a4", "a1", "a3"]
    assert ports.queue.length() == 3
    ports.queue.stop("a1")  # it does not run: nothing happens


def test_workers_are_seen_while_they_live(ports: Store) -> None:
    ports.queue.announce({"name": "w1", "backends": ["ipopt"]}, ttl=30.0)
    ports.queue.announce({"name": "w2"}, ttl=0.1)
    ports.queue.announce({"name": "w3"}, ttl=30.0)
    ports.queue.retire("w3")
    wait_until(lambda: len(ports.queue.workers()) == 1)
    assert ports.queue.workers() == [{"name": "w1", "backends": ["ipopt"]}]


def test_an_idempotency_key_stands_for_one_request_of_one_owner(ports: Store) -> None:
    keys = ports.idempotency
    assert keys.begin("ann", "k", "body") is None
    with pytest.raises(Conflict, match=KEY_IN_FLIGHT):
        keys.begin("ann", "k", "body")
    with pytest.raises(Conflict, match=KEY_REUSED):
        keys.begin("ann", "k", "other body")
    assert keys.begin("bob", "k", "other body") is None
    keys.finish("ann", "k", "a1")
    assert keys.begin("ann", "k", "body") == "a1"
    with pytest.raises(Conflict, match=KEY_REUSED):
        keys.begin("ann", "k", "other body")
    keys.abandon("bob", "k")
    assert keys.begin("bob", "k", "body") is None


def test_the_server_answers(ports: Store) -> None:
    ports.ping()
    ports.durable()
    assert ports.uptime() >= 0
