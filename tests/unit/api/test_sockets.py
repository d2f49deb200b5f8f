"""What only a real socket shows: bodies that lie, streams that flow, clients that leave."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import FastAPI

import examples
from api.settings import ApiSettings
from tests.unit.api.conftest import Hand

Address = tuple[str, int]


@pytest.fixture
def settings() -> ApiSettings:
    return ApiSettings(body_bytes=100_000, body_seconds=0.5)


@pytest.fixture
def address(app: FastAPI) -> Iterator[Address]:
    config = uvicorn.Config(app, log_config=None, access_log=False, timeout_graceful_shutdown=1)
    server = uvicorn.Server(config)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        while not server.started:
            time.sleep(0.005)
        yield listener.getsockname()
        server.should_exit = True
        thread.join()


@pytest.fixture
def http(address: Address) -> Iterator[httpx.Client]:
    limits = httpx.Limits(max_connections=None)
    with httpx.Client(base_url=f"http://127.0.0.1:{address[1]}", limits=limits) as client:
        yield client
        assert client.get("/livez").status_code == 200


@contextmanager
def connection(address: Address, *lines: str, body: bytes = b"") -> Iterator[socket.socket]:
    head = "\r\n".join([*lines, "Host: 127.0.0.1", "Content-Type: application/json"])
    with socket.create_connection(address, timeout=10) as sock:
        sock.sendall(head.encode() + b"\r\n\r\n" + body)
        yield sock


def status(sock: socket.socket) -> int:
    return int(sock.recv(65_536).split()[1])


def post(http: httpx.Client) -> str:
    return str(http.post("/v1/jobs", json=examples.load("block_min_force")).json()["id"])


@pytest.mark.usefixtures("http")
class TestBodies:
    def test_too_many_chunks(self, http: httpx.Client) -> None:
        chunks = (b"x" * 10_000 for _ in range(60))
        headers = {"Content-Type": "application/json"}
        assert http.post("/v1/jobs", content=chunks, headers=headers).status_code == 413

    def test_a_declared_length_over_the_cap(self, http: httpx.Client) -> None:
        assert http.post("/v1/jobs", content=b"x" * 200_000).status_code == 413

    def test_a_client_that_asks_first_need_not_send(self, address: Address) -> None:
        lines = "POST /v1/jobs HTTP/1.1", f"Content-Length: {10**15}", "Expect: 100-continue"
        with connection(address, *lines) as sock:
            assert status(sock) == 413

    def test_an_endless_body_is_not_read_for_ever(self, address: Address) -> None:
        lines = "POST /v1/jobs HTTP/1.1", f"Content-Length: {10**15}"
        with connection(address, *lines, body=b"x" * 900_000) as sock:
            assert status(sock) == 413

    def test_more_than_was_declared(self, address: Address) -> None:
        lines = "POST /v1/jobs HTTP/1.1", "Content-Length: 2"
        with connection(address, *lines, body=b"{}" + b"x" * 1000) as sock:
            assert status(sock) == 422

    def test_less_than_was_declared(self, address: Address) -> None:
        with connection(address, "POST /v1/jobs HTTP/1.1", "Content-Length: 99", body=b"{}"):
            pass

    @pytest.mark.parametrize("length", ["-1", "x", "1e3"])
    def test_no_length_at_all(self, address: Address, length: str) -> None:
        with connection(address, "POST /v1/jobs HTTP/1.1", f"Content-Length: {length}") as sock:
            assert status(sock) == 400

    def test_a_body_that_never_comes(self, address: Address) -> None:
        start = time.monotonic()
        lines = "POST /v1/jobs HTTP/1.1", "Content-Length: 99"
        with connection(address, *lines, body=b"{") as sock:
            assert status(sock) == 408
        assert 0.4 < time.monotonic() - start < 3


class TestStreams:
    def test_events_come_while_the_job_runs(self, http: httpx.Client, hand: Hand) -> None:
        job_id = post(http)
        record = hand.start(job_id)
        with http.stream("GET", f"/v1/jobs/{job_id}/events") as reply:
            lines = reply.iter_lines()
            for iteration in range(3):
                hand.iterate(record, iteration)
                assert next(line for line in lines if f'"iteration":{iteration}' in line)
            hand.end(record)
            assert next(line for line in lines if '"terminal":true' in line)
            assert not any(line.startswith("data") for line in lines)

    def test_more_open_streams_than_threads_leave_the_service_free(
        self, http: httpx.Client, hand: Hand
    ) -> None:
        job_id = post(http)
        record = hand.start(job_id)
        with ExitStack() as streams:
            replies: list[Any] = [
                streams.enter_context(http.stream("GET", f"/v1/jobs/{job_id}/events"))
                for _ in range(100)
            ]
            start = time.monotonic()
            assert http.get("/v1/jobs").status_code == 200
            assert http.post("/v1/jobs?validate_only=1", json={}).status_code == 422
            assert time.monotonic() - start < 2
            hand.end(record)
            for reply in replies:
                assert '"terminal":true' in reply.read().decode()

    def test_a_client_that_leaves_a_long_poll(self, http: httpx.Client) -> None:
        job_id = post(http)
        with pytest.raises(httpx.ReadTimeout):
            http.get(f"/v1/jobs/{job_id}?wait=60", timeout=0.2)
        with pytest.raises(httpx.ReadTimeout):
            http.get(f"/v1/jobs/{job_id}/events", timeout=0.2).read()
