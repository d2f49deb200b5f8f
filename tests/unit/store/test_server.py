"""What the store makes of servers that are old, away, or without a disk."""

import logging
from pathlib import Path
from typing import Any

import pytest
from redis import Redis
from redis.exceptions import (
    AuthenticationError,
    OutOfMemoryError,
    ResponseError,
)

from schemas.errors import StoreUnavailable
from store import connect
from store.backend.connection import open_client, unavailable
from store.backend.queue import open_queue
from store.backend.server import Server
from store.embedded import EmbeddedServer
from store.settings import NONE
from tests.support.service import submit


class OldRedis:
    """Answers as a server of another version would."""

    def __init__(self, version: str) -> None:
        self.version = version

    def ping(self) -> bool:
        return True

    def info(self, section: str) -> dict[str, Any]:
        assert section == "server"
        return {"redis_version": self.version, "uptime_in_seconds": 5}


def test_a_server_that_is_away_is_unavailable(tmp_path: Path) -> None:
    store = connect(f"unix://{tmp_path}/nobody", patience=NONE)
    for call in (store.ping, store.durable, store.queue.length, store.jobs.live, store.uptime):
        with pytest.raises(StoreUnavailable, match="does not answer"):
            call()


def test_too_old_a_server_is_refused() -> None:
    with pytest.raises(StoreUnavailable, match=r"Redis 6\.0"):
        Server(OldRedis("6.0.16")).ping()  # type: ignore[arg-type]
    Server(OldRedis("6.2.0")).ping()  # type: ignore[arg-type]


def test_a_server_that_cannot_tell_of_its_disk_promises_less(
    caplog: pytest.LogCaptureFixture,
) -> None:
    server = Server(OldRedis("7.0.5"))  # type: ignore[arg-type]
    with caplog.at_level(logging.WARNING):
        server.durable()
        server.durable()
    assert len(caplog.records) == 1
    assert "may be lost" in caplog.text


def test_a_server_without_its_file_promises_less(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with EmbeddedServer(tmp_path) as server:
        store = connect(server.url)
        store.durable()
        Redis.from_url(server.url).config_set("appendonly", "no")
        store.durable()
    assert "may be lost" in caplog.text


def test_foreign_errors_get_our_names() -> None:
    assert "password" in str(unavailable(AuthenticationError("no")))
    assert "memory" in str(unavailable(OutOfMemoryError("full")))
    bug = ResponseError("ERR unknown command")
    assert unavailable(bug) is bug


def test_only_the_id_travels_and_never_a_pickle(queue_url: str) -> None:
    store = connect(queue_url)
    job_id = submit(store)
    client = open_client(queue_url, NONE)
    job = open_queue(client).fetch_job(job_id)
    assert job is not None
    assert (job.args, job.kwargs, job.func_name) == ([job_id], {}, "worker.run.perform")
    assert job.description == f"job {job_id}"
    assert job.timeout == 631  # the budget of 600 s and the outer net
    client.close()
