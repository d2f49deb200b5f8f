"""What the port of sweeps promises, in memory and on a server."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

import store.memory
from schemas.errors import BadProblem, UnknownSweep
from schemas.events import PointEnded, StateChanged
from schemas.jobs import JobError, JobKind, JobStatus
from schemas.sweeps import PointOutcome, PointStatus
from store import connect
from store.ports import JobRecord, Store, SweepRecord
from store.settings import StoreSettings

Make = Callable[[StoreSettings], Store]
RUNNING = frozenset({JobStatus.RUNNING})
SOLVED = PointOutcome(
    status=PointStatus.SUCCEEDED,
    solution_status="converged",
    objective=-0.1,
    verdict="certified",
    iterations=9,
    seconds=0.25,
    warm=True,
    message="done",
)
FAILED = PointOutcome(
    status=PointStatus.FAILED, message="why", error=JobError(type="engine-fault", message="why")
)


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
    return make(StoreSettings())


def add(ports: Store, sweep_id: str = "s1", **changes: object) -> SweepRecord:
    record = SweepRecord(
        id=sweep_id, owner="ann", name="n \n'", created=100.5, total=4, chunk=2, jobs=("a1", "a2")
    )
    record = replace(record, **changes)  # type: ignore[arg-type]
    ports.sweeps.create(record, b'{"base": {}}')
    return record


def chunk(ports: Store, job_id: str = "a1") -> JobRecord:
    """A running chunk of the sweep s1."""
    record = JobRecord(
        id=job_id,
        owner="ann",
        name="n",
        spec_sha256="f",
        status=JobStatus.QUEUED,
        created=100.5,
        kind=JobKind.SWEEP_CHUNK,
        sweep="s1",
        points=2,
    )
    ports.jobs.create(record, b"{}")
    assert ports.jobs.get(job_id) == record
    claimed = ports.jobs.claim(job_id, "w1")
    assert claimed is not None
    return claimed


def handed_on(ports: Store, job: JobRecord) -> JobRecord:
    """The same job's next attempt."""
    ports.jobs.move(job.id, JobStatus.QUEUED, expect=RUNNING)
    claimed = ports.jobs.claim(job.id, "w2")
    assert claimed is not None
    return claimed


def test_a_record_comes_back_as_it_was_stored(ports: Store) -> None:
    record = add(ports)
    assert ports.sweeps.get("s1") == ports.sweeps.get("s1", "ann") == record
    assert ports.sweeps.plan("s1") == b'{"base": {}}'
    points = ports.sweeps.points("s1")
    assert (points.ended, points.begun) == ({}, {})


def test_foreign_and_unknown_sweeps_are_the_same(ports: Store) -> None:
    add(ports)
    for call in (
        lambda: ports.sweeps.get("s1", "bob"),
        lambda: ports.sweeps.get("s2"),
        lambda: ports.sweeps.plan("s2"),
        lambda: ports.sweeps.delete("s1", "bob"),
        lambda: ports.sweeps.delete("s2", "ann"),
    ):
        with pytest.raises(UnknownSweep):
            call()
    assert ports.sweeps.points("s2").ended == {}
    assert ports.sweeps.result("s2", 0) is None


def test_a_point_ends_with_its_outcome_result_and_event(ports: Store) -> None:
    add(ports)
    job = chunk(ports)
    assert ports.sweeps.begin("s1", 0, job) == 1
    assert ports.sweeps.end("s1", 0, job, SOLVED, b'{"a": 1}')
    assert ports.sweeps.end("s1", 1, job, FAILED, None)
    points = ports.sweeps.points("s1")
    assert points.ended == {0: SOLVED, 1: FAILED}
    assert points.begun == {0: 1}
    assert ports.sweeps.result("s1", 0) == b'{"a": 1}'
    assert ports.sweeps.result("s1", 1) is None
    events = [each.event for each in ports.events.read("a1")]
    ended = [event for event in events if not isinstance(event, StateChanged)]
    assert ended == [
        PointEnded(
            index=0,
            status="succeeded",
            solution_status="converged",
            objective=-0.1,
            seconds=0.25,
        ),
        PointEnded(index=1, status="failed"),
    ]


def test_a_point_ends_once(ports: Store) -> None:
    """A call whose reply was lost is repeated; what was stored stays."""
    add(ports)
    job = chunk(ports)
    assert ports.sweeps.end("s1", 0, job, SOLVED, b"1")
    assert ports.sweeps.end("s1", 0, job, FAILED, b"2")
    assert ports.sweeps.points("s1").ended == {0: SOLVED}
    assert ports.sweeps.result("s1", 0) == b"1"
    events = [each.event for each in ports.events.read("a1")]
    assert len([event for event in events if isinstance(event, PointEnded)]) == 1


def test_a_stale_attempt_writes_nothing(ports: Store) -> None:
    add(ports)
    stale = chunk(ports)
    live = handed_on(ports, stale)
    assert ports.sweeps.begin("s1", 0, stale) == 0
    assert not ports.sweeps.end("s1", 0, stale, SOLVED, b"1")
    assert ports.sweeps.points("s1").ended == {}
    assert ports.sweeps.begin("s1", 0, live) == 1
    assert ports.sweeps.end("s1", 0, live, SOLVED, b"1")
    ports.jobs.move("a1", JobStatus.SUCCEEDED, expect=RUNNING)
    assert not ports.sweeps.end("s1", 1, live, SOLVED, b"1")


def test_beginnings_count_over_attempts(ports: Store) -> None:
    add(ports)
    job = chunk(ports)
    assert [ports.sweeps.begin("s1", 1, job) for _ in range(2)] == [1, 2]
    assert ports.sweeps.begin("s1", 1, handed_on(ports, job)) == 3
    assert ports.sweeps.points("s1").begun == {1: 3}


def test_a_job_that_is_being_cancelled_keeps_its_iterate(ports: Store) -> None:
    add(ports)
    job = chunk(ports)
    ports.jobs.move("a1", JobStatus.CANCELLING, expect=RUNNING)
    assert ports.sweeps.end("s1", 0, job, SOLVED, b"1")


def test_a_cancel_is_noted_once(ports: Store) -> None:
    add(ports)
    before = time.time()
    ports.sweeps.cancel("s1")
    first = ports.sweeps.get("s1").cancelled
    assert first is not None
    assert first >= before
    ports.sweeps.cancel("s1")
    assert ports.sweeps.get("s1").cancelled == first


def test_deleting_forgets_everything(ports: Store) -> None:
    add(ports)
    job = chunk(ports)
    ports.sweeps.begin("s1", 0, job)
    ports.sweeps.end("s1", 0, job, SOLVED, b"1")
    ports.sweeps.delete("s1", "ann")
    assert ports.sweeps.result("s1", 0) is None
    assert ports.sweeps.points("s1").ended == {}
    assert ports.sweeps.list("ann").records == []
    assert ports.sweeps.begin("s1", 1, job) == 0
    assert not ports.sweeps.end("s1", 1, job, SOLVED, b"1")
    assert ports.sweeps.points("s1").begun == {}


def test_newest_first_in_pages_of_ones_own(ports: Store) -> None:
    for number in range(5):
        add(ports, f"s{number}", created=100.0 + number // 2)
    add(ports, "other", owner="bob")
    seen: list[str] = []
    cursor = None
    while True:
        page = ports.sweeps.list("ann", cursor=cursor, limit=2)
        seen += [record.id for record in page.records]
        cursor = page.next
        if cursor is None:
            break
    assert seen == ["s4", "s3", "s2", "s1", "s0"]
    with pytest.raises(BadProblem):
        ports.sweeps.list("ann", cursor="!")


def test_results_and_sweeps_are_kept_for_their_time(make: Make) -> None:
    ports = make(StoreSettings(retention=1.0, memory=2.0))
    add(ports)
    job = chunk(ports)
    ports.sweeps.end("s1", 0, job, SOLVED, b"1")
    assert ports.sweeps.result("s1", 0) == b"1"
    time.sleep(1.1)
    assert ports.sweeps.result("s1", 0) is None
    assert ports.sweeps.get("s1").total == 4
    time.sleep(1.1)
    with pytest.raises(UnknownSweep):
        ports.sweeps.get("s1")
    assert ports.sweeps.list("ann").records == []


def test_chunks_are_in_no_listing_of_jobs(ports: Store) -> None:
    add(ports)
    chunk(ports)
    assert ports.jobs.list("ann").records == []
    assert [record.id for record in ports.jobs.live()] == ["a1"]
    found = ports.jobs.many(["a1", "nothing"])
    assert [record.id if record else None for record in found] == ["a1", None]
    assert list(ports.jobs.many([])) == []
