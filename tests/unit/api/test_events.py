"""The stream of a job's events."""

import threading
import time
from dataclasses import dataclass

import orjson
import pytest

import examples
from schemas.errors import StoreUnavailable
from schemas.jobs import JobStatus
from store.ports import Store
from tests.support.asgi import AppClient
from tests.unit.api.conftest import Hand


@dataclass(frozen=True)
class Sent:
    """One event of a stream as a client reads it."""

    id: str
    type: str
    data: dict


def parse(text: str) -> list[Sent]:
    blocks = [dict(line.split(": ", 1) for line in block.splitlines() if line[0] != ":")
              for block in text.strip().split("\n\n")]  # fmt: skip
    return [
        Sent(block["id"], block["event"], orjson.loads(block["data"]))
        for block in blocks
        if "data" in block
    ]


@pytest.fixture
def job_id(client: AppClient) -> str:
    return str(client.post("/v1/jobs", json=examples.load("block_min_force")).json()["id"])


def test_a_live_job_streams_to_its_end(client: AppClient, hand: Hand, job_id: str) -> None:
    def work() -> None:
        time.sleep(0.1)
        record = hand.start(job_id)
        hand.iterate(record, 1)
        time.sleep(0.1)
        hand.iterate(record, 2)
        hand.end(record)

    worker = threading.Thread(target=work)
    worker.start()
    reply = client.get(f"/v1/jobs/{job_id}/events")
    worker.join()
    assert reply.headers["content-type"].startswith("text/event-stream")
    assert reply.headers["cache-control"] == "no-cache"
    events = parse(reply.text)
    states = [event.data["status"] for event in events if event.type == "state"]
    assert states == ["queued", "running", "succeeded"]
    iterations = [e.data["iteration"] for e in events if e.type == "nlp_iteration"]
    assert iterations == [1, 2]
    assert events[-1].data["terminal"] is True


def test_it_resumes_after_the_last_event_id(client: AppClient, hand: Hand, job_id: str) -> None:
    record = hand.start(job_id)
    hand.iterate(record, 1)
    hand.end(record)
    url = f"/v1/jobs/{job_id}/events"
    everything = parse(client.get(url).text)
    assert len(everything) == 4
    for index, event in enumerate(everything[:-1]):
        rest = parse(client.get(url, headers={"Last-Event-ID": event.id}).text)
        assert rest == everything[index + 1 :]


def test_after_the_end_the_terminal_event_is_replayed(
    client: AppClient, hand: Hand, job_id: str
) -> None:
    hand.solve(job_id)
    url = f"/v1/jobs/{job_id}/events"
    last = parse(client.get(url).text)[-1]
    assert parse(client.get(url, headers={"Last-Event-ID": last.id}).text) == [last]


@pytest.mark.parametrize("after", ["x", "-1", "9" * 40, "1-", "\u00e9", "$", ""])
def test_a_foreign_id_starts_from_the_beginning(
    client: AppClient, hand: Hand, job_id: str, after: str
) -> None:
    hand.end(hand.start(job_id), JobStatus.FAILED)
    headers = {"Last-Event-ID": after.encode("latin-1")}
    reply = client.get(f"/v1/jobs/{job_id}/events", headers=headers)
    assert len(parse(reply.text)) == 3


def test_a_store_that_goes_away_ends_the_stream(
    client: AppClient, store: Store, job_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*_: object, **__: object) -> object:
        raise StoreUnavailable("The queue server does not answer.")

    monkeypatch.setattr(store.events, "follow", gone)
    reply = client.get(f"/v1/jobs/{job_id}/events")
    assert reply.status_code == 200
    assert reply.text.endswith(": The queue server does not answer.\n\n")


def test_a_job_deleted_meanwhile_ends_the_stream(
    client: AppClient, store: Store, hand: Hand, job_id: str
) -> None:
    def forget() -> None:
        hand.end(hand.start(job_id))
        store.jobs.delete(job_id, "local")

    timer = threading.Timer(0.1, forget)
    timer.start()
    assert client.get(f"/v1/jobs/{job_id}/events").status_code == 200
    timer.join()
