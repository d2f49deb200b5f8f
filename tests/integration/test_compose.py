"""The compose file's own commands, run as processes against each other, solve a problem."""

import os
import secrets
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
from redis import Redis
from redis.backoff import NoBackoff
from redis.exceptions import AuthenticationError, RedisError
from redis.retry import Retry

import examples
from store.embedded import binary
from tests.support.containers import compose, dockerfile

START_SECONDS = 30
KEY = secrets.token_hex(16)
SECRETS = {"REDIS_PASSWORD": secrets.token_hex(24), "FOOTFALL_KEYS": f"alice:{KEY}"}


@dataclass
class Deployment:
    """The services of the compose file on this machine: other ports, another data folder."""

    folder: Path
    queue_port: int
    api_port: int
    services: dict[str, Any] = field(default_factory=lambda: compose(SECRETS)["services"])

    def here(self, text: str) -> str:
        """A text of the compose file, with the containers' places turned into this machine's."""
        text = text.replace("@queue:6379", f"@127.0.0.1:{self.queue_port}")
        text = text.replace(" /data ", f" {self.folder} ")
        return text.replace("127.0.0.1:8000", f"127.0.0.1:{self.api_port}")

    def environment(self, name: str) -> dict[str, str]:
        """What the container would have: the image's variables, and the service's over them."""
        service = self.services[name]
        image = dockerfile(service).environment if "build" in service else {}
        own = {key: self.here(str(value)) for key, value in service["environment"].items()}
        path = os.pathsep.join(
            [str(self.folder), str(Path(sys.executable).parent), "/usr/bin:/bin"]
        )
        port = {"FOOTFALL_PORT": str(self.api_port)} if name == "api" else {}
        return image | own | port | {"PATH": path}

    def command(self, name: str) -> list[str]:
        """What the container runs."""
        service = self.services[name]
        words = service.get("command") or dockerfile(service).command
        return [self.here(word) for word in words]

    def healthy(self, name: str) -> subprocess.CompletedProcess[str]:
        """One run of the health check, the service's own or its image's."""
        service = self.services[name]
        own = service.get("healthcheck", {}).get("test")
        words = own[1:] if own else dockerfile(service).health
        return subprocess.run(
            [self.here(word) for word in words],
            env=self.environment(name),
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )

    def start(self, name: str) -> subprocess.Popen[bytes]:
        """Start one service. Its output goes to the test's own."""
        return subprocess.Popen(self.command(name), env=self.environment(name), cwd=self.folder)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


def put_server_on_path(folder: Path, port: int) -> None:
    """The image's ``valkey-server``: the embedded binary, on a free port of the loopback."""
    script = folder / "valkey-server"
    script.write_text(f'#!/bin/sh\nexec "{binary()}" "$@" --port {port} --bind 127.0.0.1\n')
    script.chmod(script.stat().st_mode | stat.S_IXUSR)


def wait_until(
    condition: Callable[[], bool], processes: Mapping[str, subprocess.Popen[bytes]]
) -> None:
    """Poll until it holds; fail at once if a service has ended."""
    end = time.monotonic() + START_SECONDS
    while not condition():
        ended = {name: process.poll() for name, process in processes.items()}
        assert not any(code is not None for code in ended.values()), f"ended: {ended}"
        assert time.monotonic() < end, f"not well within {START_SECONDS} s"
        time.sleep(0.1)


@pytest.fixture(scope="module")
def deployment(tmp_path_factory: pytest.TempPathFactory) -> Deployment:
    folder = tmp_path_factory.mktemp("deployment")
    deployment = Deployment(folder, free_port(), free_port())
    put_server_on_path(folder, deployment.queue_port)
    return deployment


@pytest.fixture(scope="module")
def processes(deployment: Deployment) -> Iterator[Mapping[str, subprocess.Popen[bytes]]]:
    """Started in the order of ``depends_on``, ended by SIGTERM in the reverse one."""
    with ExitStack() as stack:
        started: dict[str, subprocess.Popen[bytes]] = {}
        for name in ("queue", "worker", "api"):
            started[name] = stack.enter_context(deployment.start(name))
            stack.callback(started[name].terminate)
            if name == "queue":
                wait_until(lambda: answers(deployment.queue_port), started)
        wait_until(lambda: deployment.healthy("api").returncode == 0, started)
        yield started


def queue(port: int, password: str | None = SECRETS["REDIS_PASSWORD"]) -> Redis:
    """A client that asks once."""
    return Redis(port=port, password=password, retry=Retry(NoBackoff(), 0), decode_responses=True)


def answers(port: int) -> bool:
    try:
        with queue(port) as client:
            return bool(client.ping())
    except RedisError:
        return False


@pytest.fixture(scope="module")
def client(deployment: Deployment, processes: object) -> Iterator[httpx.Client]:
    headers = {"Authorization": f"Bearer {KEY}"}
    base_url = f"http://127.0.0.1:{deployment.api_port}"
    with httpx.Client(base_url=base_url, headers=headers, timeout=70) as client:
        yield client


def test_the_services_solve_a_problem(client: httpx.Client) -> None:
    problem = examples.load("cart_pole")
    reply = client.post("/v1/jobs", json=problem, headers={"Prefer": "wait=60"})
    assert reply.status_code == 200, reply.text
    assert reply.json()["result"]["status"] == "converged"
    (known,) = problem["known"]
    assert reply.json()["result"]["objective"] == pytest.approx(known["value"], abs=1e-3)


def test_the_health_checks_pass(deployment: Deployment, processes: object) -> None:
    for name in ("api", "worker"):
        check = deployment.healthy(name)
        assert check.returncode == 0, check.stdout + check.stderr


def test_the_service_asks_for_a_key(client: httpx.Client) -> None:
    assert httpx.get(client.base_url.join("/v1/jobs")).status_code == 401
    assert client.get("/v1/jobs").status_code == 200


def test_the_queue_asks_for_the_password(deployment: Deployment, processes: object) -> None:
    with queue(deployment.queue_port, None) as stranger, pytest.raises(AuthenticationError):
        stranger.ping()


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_no_list_of_processes_shows_the_password(
    processes: Mapping[str, subprocess.Popen[bytes]],
) -> None:
    for process in processes.values():
        line = Path(f"/proc/{process.pid}/cmdline").read_text()
        assert SECRETS["REDIS_PASSWORD"] not in line


def test_the_queue_runs_as_the_documents_ask(deployment: Deployment, processes: object) -> None:
    with queue(deployment.queue_port) as client:
        settings = client.config_get("appendonly", "appendfsync", "maxmemory-policy", "save")
    assert settings == {
        "appendonly": "yes",
        "appendfsync": "everysec",
        "maxmemory-policy": "noeviction",
        "save": "",
    }


def test_sigterm_ends_worker_and_api(
    deployment: Deployment, processes: Mapping[str, subprocess.Popen[bytes]]
) -> None:
    for name in ("api", "worker"):
        processes[name].terminate()
        processes[name].wait(10)
    check = deployment.healthy("worker")
    assert check.returncode != 0, "a worker that is gone is not healthy"
    assert answers(deployment.queue_port), "the queue server outlives them"


def test_a_queue_without_the_server_is_an_error_with_its_reason(deployment: Deployment) -> None:
    nowhere = Deployment(deployment.folder, free_port(), free_port())
    run = subprocess.run(
        [*nowhere.command("worker"), "--check"],
        env=nowhere.environment("worker"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode != 0
    assert "queue server" in run.stderr
