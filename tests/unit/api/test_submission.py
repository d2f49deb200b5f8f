"""POST /v1/jobs."""

import hashlib
import threading
import time
from dataclasses import replace
from typing import Any

import orjson
import pytest

import examples
from api.settings import ApiSettings
from schemas.errors import StoreUnavailable
from schemas.jobs import JobStatus
from schemas.reading import canonical, read_problem, spec_sha256
from store.memory import connect
from store.ports import JobRecord, Store
from store.settings import StoreSettings
from tests.support.asgi import AppClient
from tests.unit.api.conftest import Hand


def problem(**changes: Any) -> dict[str, Any]:
    return examples.load("block_min_force") | changes


def test_a_posted_problem_is_stored_queued_and_answered(client: AppClient, store: Store) -> None:
    reply = client.post("/v1/jobs", json=problem())
    assert reply.status_code == 202
    job = reply.json()
    assert reply.headers["location"] == job["links"]["self"] == f"/v1/jobs/{job['id']}"
    assert int(reply.headers["retry-after"]) >= 1
    assert job["status"] == "queued"
    assert job["queue_position"] == 0
    assert job["links"]["cancel"].endswith("/cancel")
    assert store.queue.waiting() == [job["id"]]
    stored = read_problem(store.jobs.problem(job["id"]))
    assert canonical(stored) == canonical(read_problem(problem()))
    assert store.jobs.get(job["id"]).spec_sha256 == spec_sha256(stored)


class TestOrder:
    """The record first, then the queue, then the disk, then the reply."""

    @pytest.fixture
    def on_disk(self) -> list[tuple[list[str], int]]:
        return []

    @pytest.fixture
    def store(self, on_disk: list[tuple[list[str], int]]) -> Store:
        store = connect()

        def durable() -> None:
            waiting = [*store.queue.waiting()]
            on_disk.append((waiting, len(store.jobs.live())))

        return replace(store, durable=durable)

    def test_what_is_on_disk_at_the_reply(
        self, client: AppClient, on_disk: list[tuple[list[str], int]]
    ) -> None:
        job = client.post("/v1/jobs", json=problem()).json()
        assert on_disk == [([job["id"]], 1)]

    def test_the_record_is_there_when_the_id_is_queued(
        self, client: AppClient, store: Store, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        found: list[JobRecord] = []
        plain = type(store.queue).enqueue

        def enqueue(queue: Any, job_id: str) -> None:
            found.append(store.jobs.get(job_id))
            plain(queue, job_id)

        monkeypatch.setattr(type(store.queue), "enqueue", enqueue)
        assert client.post("/v1/jobs", json=problem()).status_code == 202
        assert len(found) == 1


def test_limits_are_capped_in_what_is_stored(client: AppClient, store: Store) -> None:
    asked = problem(limits={"seconds": 80_000, "megabytes": 900_000})
    job = client.post("/v1/jobs", json=asked).json()
    record = store.jobs.get(job["id"])
    assert (record.seconds, record.megabytes) == (3600, 8192)
    assert read_problem(store.jobs.problem(job["id"])).limits.seconds == 3600


class TestPrefer:
    def test_an_ended_job_comes_with_its_result(
        self, client: AppClient, store: Store, hand: Hand
    ) -> None:
        done: dict[str, Any] = {}

        def work() -> None:
            while not store.queue.waiting():
                time.sleep(0.005)
            done["result"] = hand.solve(store.queue.waiting()[0])

        worker = threading.Thread(target=work)
        worker.start()
        reply = client.post("/v1/jobs", json=problem(), headers={"Prefer": "wait=20"})
        worker.join()
        assert reply.status_code == 200
        assert reply.headers["preference-applied"] == "wait=20"
        assert reply.json()["status"] == "succeeded"
        assert reply.json()["result"] == done["result"]

    def test_a_job_that_takes_longer_is_accepted(self, client: AppClient) -> None:
        start = time.monotonic()
        reply = client.post("/v1/jobs", json=problem(), headers={"Prefer": "wait=1"})
        assert reply.status_code == 202
        assert 0.9 < time.monotonic() - start < 3
        assert reply.json()["status"] == "queued"

    @pytest.mark.parametrize("text", ["wait", "wait=soon", "respond-async", "wait=-1", "xwait=3"])
    def test_a_preference_that_cannot_be_read_is_no_error(
        self, client: AppClient, text: str
    ) -> None:
        reply = client.post("/v1/jobs", json=problem(), headers={"Prefer": text})
        assert reply.status_code == 202
        assert "preference-applied" not in reply.headers


class TestIdempotencyKey:
    def test_the_same_key_and_body_make_one_job(self, client: AppClient, store: Store) -> None:
        first, second = (
            client.post("/v1/jobs", json=problem(), headers={"Idempotency-Key": "k"})
            for _ in range(2)
        )
        assert first.json()["id"] == second.json()["id"]
        assert second.status_code == 202
        assert second.headers["idempotency-replayed"] == "true"
        assert "idempotency-replayed" not in first.headers
        assert len(store.queue.waiting()) == 1

    def test_another_body_is_refused(self, client: AppClient) -> None:
        client.post("/v1/jobs", json=problem(), headers={"Idempotency-Key": "k"})
        reply = client.post("/v1/jobs", json=problem(name="b"), headers={"Idempotency-Key": "k"})
        assert reply.status_code == 422
        assert reply.json()["type"] == "/problems/key-reused"

    def test_a_key_in_flight_is_a_conflict(self, client: AppClient, store: Store) -> None:
        body = orjson.dumps(problem())
        store.idempotency.begin("local", "k", hashlib.sha256(body).hexdigest())
        headers = {"Idempotency-Key": "k", "Content-Type": "application/json"}
        reply = client.post("/v1/jobs", content=body, headers=headers)
        assert reply.status_code == 409
        assert "in flight" in reply.json()["detail"]

    def test_a_bad_problem_leaves_the_key_free(self, client: AppClient) -> None:
        headers = {"Idempotency-Key": "k"}
        assert client.post("/v1/jobs", json={}, headers=headers).status_code == 422
        assert client.post("/v1/jobs", json=problem(), headers=headers).status_code == 202

    def test_a_queue_lost_halfway_makes_no_second_job(
        self, client: AppClient, store: Store, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The record is there but the queue fails: the sweep queues it, the repeat finds it."""

        def gone(*_: object) -> None:
            raise StoreUnavailable("The queue server does not answer.")

        headers = {"Idempotency-Key": "k"}
        with monkeypatch.context() as broken:
            broken.setattr(type(store.queue), "enqueue", gone)
            assert client.post("/v1/jobs", json=problem(), headers=headers).status_code == 503
        assert client.post("/v1/jobs", json=problem(), headers=headers).status_code == 202
        assert len(client.get("/v1/jobs").json()["jobs"]) == 1

    def test_the_key_of_a_deleted_job_is_a_conflict(self, client: AppClient) -> None:
        headers = {"Idempotency-Key": "k"}
        job = client.post("/v1/jobs", json=problem(), headers=headers).json()
        client.delete(job["links"]["self"])
        client.delete(job["links"]["self"])
        reply = client.post("/v1/jobs", json=problem(), headers=headers)
        assert reply.status_code == 409
        assert "new key" in reply.json()["hint"]

    @pytest.mark.parametrize("key", ["", "x" * 201, "a b"])
    def test_a_malformed_key_is_named(self, client: AppClient, key: str) -> None:
        reply = client.post("/v1/jobs", json=problem(), headers={"Idempotency-Key": key})
        assert reply.status_code == 422
        assert reply.json()["errors"][0]["parameter"] == "idempotency-key"


class TestValidateOnly:
    def test_nothing_is_stored(self, client: AppClient, store: Store) -> None:
        reply = client.post("/v1/jobs?validate_only=true", json=problem())
        assert reply.status_code == 200
        assert reply.json()["valid"] is True
        assert reply.json()["warnings"] == []
        assert store.queue.waiting() == []
        assert client.get("/v1/jobs").json()["jobs"] == []

    def test_warnings_say_where(self, client: AppClient) -> None:
        corner = problem(limits={"seconds": 80_000})
        corner["phases"][0]["integrals"]["work"] = "abs(u*v)"
        reply = client.post("/v1/jobs?validate_only=true", json=corner).json()
        assert reply["limits"]["seconds"] == 3600
        limit, note = reply["warnings"]
        assert limit.startswith("/limits/seconds")
        assert note.startswith("/phases/0/integrals/work: abs")

    def test_a_bad_problem_is_still_422(self, client: AppClient) -> None:
        assert client.post("/v1/jobs?validate_only=1", json={"name": 3}).status_code == 422


class TestBadProblem:
    def test_every_error_has_a_pointer_and_a_mend(self, client: AppClient) -> None:
        bad = problem()
        bad["phases"][0]["system"]["derivatives"]["v"] = "u + qq"
        reply = client.post("/v1/jobs", json=bad)
        assert reply.status_code == 422
        assert reply.headers["content-type"] == "application/problem+json"
        document = reply.json()
        assert document["type"] == "/problems/bad-problem"
        (error,) = document["errors"]
        assert error["pointer"] == "/phases/0/system/derivatives/v"
        assert error["column"] == 5
        assert error["hint"]
        assert error["message"] in document["detail"]

    def test_several_errors_are_all_listed(self, client: AppClient) -> None:
        reply = client.post("/v1/jobs", json=problem(method={"kind": "magic"}, refinement=3))
        pointers = {error["pointer"] for error in reply.json()["errors"]}
        assert len(pointers) == 2
        assert reply.json()["detail"].startswith("2 errors")


class TestShare:
    @pytest.fixture
    def settings(self) -> ApiSettings:
        return ApiSettings(max_waiting_jobs=2)

    def test_an_owner_who_has_too_many_waiting_is_asked_to_wait(self, client: AppClient) -> None:
        jobs = [client.post("/v1/jobs", json=problem()) for _ in range(3)]
        assert [reply.status_code for reply in jobs] == [202, 202, 429]
        assert jobs[2].json()["type"] == "/problems/rate-limited"
        assert int(jobs[2].headers["retry-after"]) >= 1
        client.delete(jobs[0].json()["links"]["self"])
        assert client.post("/v1/jobs", json=problem()).status_code == 202


class TestFullQueue:
    @pytest.fixture
    def store(self) -> Store:
        return connect(StoreSettings(queue_limit=1))

    def test_a_full_queue_leaves_nothing_behind(self, client: AppClient, store: Store) -> None:
        headers = {"Idempotency-Key": "k"}
        client.post("/v1/jobs", json=problem())
        reply = client.post("/v1/jobs", json=problem(), headers=headers)
        assert reply.status_code == 503
        assert reply.json()["type"] == "/problems/queue-full"
        assert int(reply.headers["retry-after"]) >= 1
        (job,) = client.get("/v1/jobs").json()["jobs"]
        assert store.jobs.get(job["id"]).status is JobStatus.QUEUED
        client.delete(job["links"]["self"])
        assert client.post("/v1/jobs", json=problem(), headers=headers).status_code == 202
