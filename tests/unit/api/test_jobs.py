"""Listing, looking at, cancelling and deleting jobs."""

import threading
import time
from typing import Any

import httpx
import pytest

import examples
from schemas.jobs import JobError, JobStatus
from store.ports import Store
from tests.support.asgi import AppClient
from tests.unit.api.conftest import Hand


def post(client: AppClient, name: str = "block") -> str:
    problem = examples.load("block_min_force") | {"name": name}
    return str(client.post("/v1/jobs", json=problem).json()["id"])


def eventually(condition: Any, seconds: float = 5) -> bool:
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.005)
    return bool(condition())


class TestListing:
    def test_newest_first_in_pages(self, client: AppClient) -> None:
        ids = [post(client) for _ in range(5)]
        first = client.get("/v1/jobs?limit=3").json()
        rest = client.get("/v1/jobs", params={"limit": 3, "cursor": first["next"]}).json()
        jobs = first["jobs"] + rest["jobs"]
        assert [job["id"] for job in jobs] == ids[::-1]
        assert [job["queue_position"] for job in jobs] == [4, 3, 2, 1, 0]
        assert rest["next"] is None

    def test_filters(self, client: AppClient, hand: Hand) -> None:
        solved, waiting = post(client, "a"), post(client, "b")
        hand.solve(solved)
        assert [j["id"] for j in client.get("/v1/jobs?status=succeeded").json()["jobs"]] == [solved]
        assert [j["id"] for j in client.get("/v1/jobs?name=b").json()["jobs"]] == [waiting]

    @pytest.mark.parametrize(
        ("query", "parameter"),
        [
            ("limit=0", "limit"),
            ("limit=x", "limit"),
            ("status=odd", "status"),
            ("cursor=!", "cursor"),
        ],
    )
    def test_malformed_parameters_are_named(
        self, client: AppClient, query: str, parameter: str
    ) -> None:
        reply = client.get(f"/v1/jobs?{query}")
        assert reply.status_code == 422
        assert reply.json()["type"] == "/problems/bad-parameter"
        assert reply.json()["errors"][0]["parameter"] == parameter


class TestLooking:
    def test_progress_timings_and_attempts(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.iterate(hand.start(job_id), 7)
        job = client.get(f"/v1/jobs/{job_id}").json()
        assert job["status"] == "running"
        assert job["attempts"] == 1
        assert job["queue_position"] is None
        assert job["progress"]["iteration"] == 7
        assert job["timings"]["queued"] == 0.1
        assert job["started"].endswith("Z")

    def test_a_failure_says_why(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        error = JobError(type="invalid-model", message="NaN at the guess", hint="Mend the guess.")
        hand.end(hand.start(job_id), JobStatus.FAILED, error=error)
        reply = client.get(f"/v1/jobs/{job_id}")
        assert reply.status_code == 200
        assert reply.json()["error"]["type"] == "invalid-model"

    @pytest.mark.parametrize("job_id", ["0" * 32, "x", "..%2f..", "%00", "a" * 5000])
    def test_an_unknown_job_is_404(self, client: AppClient, job_id: str) -> None:
        for path in ("", "/result", "/trajectory", "/report.html", "/events"):
            reply = client.get(f"/v1/jobs/{job_id}{path}")
            assert reply.status_code == 404
            assert reply.headers["content-type"] == "application/problem+json"

    def test_an_unchanged_job_is_304(self, client: AppClient, hand: Hand) -> None:
        url = f"/v1/jobs/{post(client)}"
        tag = client.get(url).headers["etag"]
        same = client.get(url, headers={"If-None-Match": f'"other", W/{tag}'})
        assert same.status_code == 304
        assert same.content == b""
        assert same.headers["etag"] == tag
        hand.start(url.rsplit("/", 1)[1])
        assert client.get(url, headers={"If-None-Match": tag}).status_code == 200


class TestLongPoll:
    def later(self, action: Any) -> None:
        timer = threading.Timer(0.15, action)
        timer.daemon = True
        timer.start()

    def test_it_answers_when_the_job_ends(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        self.later(lambda: hand.solve(job_id))
        start = time.monotonic()
        assert client.get(f"/v1/jobs/{job_id}?wait=30").json()["status"] == "succeeded"
        assert time.monotonic() - start < 5

    def test_with_a_tag_it_answers_on_any_change(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        record = hand.start(job_id)
        tag = client.get(f"/v1/jobs/{job_id}").headers["etag"]
        self.later(lambda: hand.iterate(record, 3))
        reply = client.get(f"/v1/jobs/{job_id}?wait=30", headers={"If-None-Match": tag})
        assert reply.json()["status"] == "running"
        assert reply.json()["progress"]["iteration"] == 3

    def test_an_unchanged_job_is_304_after_the_wait(self, client: AppClient) -> None:
        url = f"/v1/jobs/{post(client)}"
        tag = client.get(url).headers["etag"]
        start = time.monotonic()
        assert client.get(f"{url}?wait=1", headers={"If-None-Match": tag}).status_code == 304
        assert 0.9 < time.monotonic() - start < 3

    def test_an_ended_job_is_answered_at_once(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.solve(job_id)
        start = time.monotonic()
        assert client.get(f"/v1/jobs/{job_id}?wait=30").status_code == 200
        assert time.monotonic() - start < 1

    def test_the_wait_is_bounded(self, client: AppClient) -> None:
        reply = client.get(f"/v1/jobs/{post(client)}?wait=61")
        assert reply.status_code == 422
        assert reply.json()["errors"][0]["parameter"] == "wait"


class TestCancel:
    def cancel(self, client: AppClient, job_id: str, **options: Any) -> httpx.Response:
        return client.post(f"/v1/jobs/{job_id}/cancel", **options)

    def test_a_waiting_job_ends_at_once(self, client: AppClient, store: Store) -> None:
        job_id = post(client)
        reply = self.cancel(client, job_id)
        assert reply.status_code == 202
        assert reply.json()["status"] == "cancelled"
        assert store.queue.waiting() == []
        assert self.cancel(client, job_id).json()["status"] == "cancelled"

    def test_a_running_job_is_asked_then_killed_until_it_ends(
        self, client: AppClient, hand: Hand, store: Any
    ) -> None:
        job_id = post(client)
        record = hand.start(job_id)
        assert self.cancel(client, job_id).json()["status"] == "cancelling"
        assert self.cancel(client, job_id).status_code == 202
        assert eventually(lambda: len(store.queue.stopped) >= 3)
        hand.end(record, JobStatus.CANCELLED)
        time.sleep(0.1)
        kills = len(store.queue.stopped)
        time.sleep(0.1)
        assert len(store.queue.stopped) == kills

    def test_a_job_that_obeys_is_not_killed(
        self, client: AppClient, hand: Hand, store: Any, app: Any
    ) -> None:
        app.state.context.stopper._grace = 0.3
        job_id = post(client)
        record = hand.start(job_id)
        self.cancel(client, job_id)
        hand.end(record, JobStatus.CANCELLED)
        time.sleep(0.5)
        assert store.queue.stopped == []

    def test_now_kills_at_once(self, client: AppClient, hand: Hand, store: Any, app: Any) -> None:
        app.state.context.stopper._grace = 60
        job_id = post(client)
        hand.start(job_id)
        self.cancel(client, job_id)
        self.cancel(client, job_id, json={"mode": "now"})
        assert store.queue.stopped == [job_id]

    def test_an_ended_job_stays_as_it_is(self, client: AppClient, hand: Hand) -> None:
        job_id = post(client)
        hand.solve(job_id)
        assert self.cancel(client, job_id).json()["status"] == "succeeded"

    @pytest.mark.parametrize(
        "body", [b"{", b'{"mode": "later"}', b'{"kind": 1}', b"3", b"\xff", b'{"mode": null}']
    )
    def test_a_malformed_body_is_named(self, client: AppClient, body: bytes) -> None:
        headers = {"Content-Type": "application/json"}
        reply = self.cancel(client, post(client), content=body, headers=headers)
        assert reply.status_code == 422
        assert reply.json()["type"] == "/problems/bad-parameter"

    def test_a_lost_worker_does_not_confuse_it(
        self, client: AppClient, hand: Hand, store: Store, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Between the look and the move the job goes back to the queue."""
        job_id = post(client)
        hand.start(job_id)
        move = store.jobs.move

        def lose_once(*args: Any, **options: Any) -> Any:
            monkeypatch.setattr(store.jobs, "move", move)
            moved = move(*args, **options)
            move(job_id, JobStatus.QUEUED, expect=frozenset({JobStatus.RUNNING}))
            return moved

        monkeypatch.setattr(store.jobs, "move", lose_once)
        assert self.cancel(client, job_id).json()["status"] == "cancelled"


class TestDelete:
    def test_a_live_job_is_cancelled_an_ended_one_forgotten(self, client: AppClient) -> None:
        url = f"/v1/jobs/{post(client)}"
        first = client.delete(url)
        assert first.status_code == 202
        assert first.json()["status"] == "cancelled"
        second = client.delete(url)
        assert second.status_code == 204
        assert second.content == b""
        assert client.get(url).status_code == 404
        assert client.delete(url).status_code == 404
