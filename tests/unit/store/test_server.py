"""What the store makes of servers that are old, away, or without a disk."""

import logging
import os
import signal
import time
from contextlib import closing
from dataclasses import replace
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
from store.settings import NONE, SHORT
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
    assert "disk" in str(unavailable(ResponseError("MISCONF Errors writing to the AOF file")))
    assert "too old" in str(unavailable(ResponseError("unknown command `HELLO`")))
    bug = ResponseError("ERR unknown command")
    assert unavailable(bug) is bug


@pytest.mark.parametrize("url", ["nonsense", "redis://:se#cret@host:6379", "redis://host:port"])
def test_a_url_that_cannot_be_read_is_not_shown(url: str) -> None:
    with pytest.raises(StoreUnavailable, match="REDIS_URL") as caught:
        connect(url)
    assert url not in f"{caught.value.message} {caught.value.hint}"
    assert caught.value.__suppress_context__, "the words of the cause may hold the password"


def test_a_server_that_hangs_is_asked_once(tmp_path: Path) -> None:
    """Only a worker asks again: somebody waits for every other answer."""
    brief = replace(SHORT, reply=0.2)
    with EmbeddedServer(tmp_path) as server, closing(connect(server.url, patience=brief)) as store:
        store.ping()
        os.kill(server.pid, signal.SIGSTOP)
        began = time.monotonic()
        with pytest.raises(StoreUnavailable, match="does not answer"):
            store.queue.length()
        os.kill(server.pid, signal.SIGCONT)
    assert 0.2 <= time.monotonic() - began < 1.0


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
