"""``footfall serve`` as a person runs it: one process, the whole service, a clean end."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import examples
from footfall import Client, Event
from footfall.cli import main
from footfall.errors import BadProblem, FootfallError, UnknownJob
from tests.support.service import wait_until


@contextmanager
def serving(folder: Path, *options: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The URL and the process of ``footfall serve`` on a free port."""
    command = [sys.executable, "-m", "footfall", "serve", "--port", "0", "--json"]
    with subprocess.Popen(
        [*command, "--data-dir", str(folder), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield json.loads(process.stdout.readline())["url"], process
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(15)


def children(pid: int) -> list[int]:
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def command_of(pid: int) -> str:
    return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()


def gone(pid: int) -> bool:
    return not Path(f"/proc/{pid}").exists()


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    with serving(tmp_path_factory.mktemp("serve")) as (url, process):
        yield url, process.pid


@pytest.fixture
def client(service: tuple[str, int]) -> Iterator[Client]:
    with Client(service[0]) as opened:
        yield opened


def slow_problem() -> dict[str, Any]:
    """A solve without an end: no mesh is fine enough."""
    problem = examples.load("cart_pole")
    problem["method"] = {"kind": "trapezoidal", "segments": 1500}
    return problem | {"refinement": {"tolerance": 1e-12, "max_segments": 20_000}}


def test_the_cart_pole_goes_all_the_way(client: Client) -> None:
    job = client.submit(examples.load("cart_pole"))
    events: list[Event] = []
    result = client.wait(job.id, timeout=60, on_event=events.append)
    assert result.converged
    assert result.objective == pytest.approx(58.80767, abs=1e-4)
    assert [e.data["segments"] for e in events if e.type == "mesh"] == [
        mesh["segments"] for mesh in result.mesh
    ]
    assert events[-1].terminal
    sampled = client.trajectory(job.id, samples=11)
    times = sampled["swing_up/time"]
    np.testing.assert_allclose(sampled["swing_up/states/q1"], result["q1"](times), atol=1e-12)
    assert "cart-pole swing-up" in client.report(job.id)
    assert job.id in {known.id for known in client.jobs()}
    client.delete(job.id)
    with pytest.raises(UnknownJob):
        client.job(job.id)


def test_the_gallery_and_bad_problems(client: Client) -> None:
    assert "cart_pole" in {entry["name"] for entry in client.examples()}
    assert client.validate(client.example("cart_pole")) == []
    problem = examples.load("cart_pole") | {"objective": {"minimize": "efort"}}
    (issue,) = client.validate(problem)
    assert (issue.pointer, issue.column) == ("/objective/minimize", 1)
    with pytest.raises(BadProblem, match="effort"):
        client.submit(problem)


def test_the_command_lists_the_jobs(
    service: tuple[str, int], client: Client, capsys: pytest.CaptureFixture[str]
) -> None:
    job = client.submit(examples.load("block_min_force"))
    client.wait(job.id, timeout=60)
    assert main(["jobs", "--limit", "1", "--server", service[0]]) == 0
    said = capsys.readouterr().out
    for word in (job.id, "block move", "succeeded", "converged"):
        assert word in said
    assert main(["jobs", "--json", "--server", service[0]]) == 0
    assert job.id in {known["id"] for known in json.loads(capsys.readouterr().out)}


def test_a_model_without_a_value_is_explained_like_a_bad_problem(
    service: tuple[str, int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    problem = examples.load("block_min_force")
    problem["phases"][0]["integrals"] = {"effort": "log(u - 100)"}
    path = tmp_path / "p.json"
    path.write_text(json.dumps(problem | {"objective": {"minimize": "effort"}}))
    assert main(["solve", str(path), "--server", service[0]]) == 2
    said = capsys.readouterr()
    assert not said.out
    assert f"{path}: /phases/0/integrals/effort: has no finite value" in said.err
    assert said.err.count("has no finite value") == 1


def test_a_cancelled_job_keeps_its_best_iterate(client: Client) -> None:
    job = client.submit(slow_problem())
    for event in client.events(job.id, timeout=60):
        if event.type == "nlp_iteration":
            client.cancel(job.id)
    assert client.job(job.id).status == "cancelled"
    assert client.wait(job.id, timeout=10).status == "cancelled"


def test_ctrl_c_on_the_command_cancels_the_job(service: tuple[str, int], tmp_path: Path) -> None:
    path = tmp_path / "slow.json"
    path.write_text(json.dumps(slow_problem()))
    command = [sys.executable, "-m", "footfall", "solve", str(path), "--json"]
    with subprocess.Popen(
        [*command, "--server", service[0]],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where the tests run in a shell's background, Ctrl-C is ignored and that is inherited.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    ) as process:
        assert process.stderr is not None
        while "iteration" not in process.stderr.readline():
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert json.loads(out)["status"] == "cancelled"


def test_a_dead_worker_is_started_again(service: tuple[str, int], client: Client) -> None:
    (worker,) = [pid for pid in children(service[1]) if "-m worker" in command_of(pid)]
    os.kill(worker, signal.SIGKILL)
    job = client.submit(examples.load("block_min_force"))
    assert client.wait(job.id, timeout=60).converged


def longer_than_a_moment() -> dict[str, Any]:
    problem = examples.load("cart_pole") | {"refinement": None}
    problem["method"] = {"kind": "trapezoidal", "segments": 1500}
    return problem | {"solver": {"tolerance": 1e-12}}


def attempts(client: Client, job_id: str) -> int:
    """How many have begun; 0 while the service cannot say."""
    with suppress(FootfallError):
        return client.job(job_id).attempts
    return 0


def test_a_killed_api_and_queue_server_are_started_again(
    service: tuple[str, int], client: Client
) -> None:
    """The solve goes on meanwhile, and what waits is not lost."""
    running = client.submit(longer_than_a_moment())
    waiting = client.submit(examples.load("block_min_force"))
    wait_until(lambda: attempts(client, running.id) == 1)
    for part in ("-m api", "valkey-server"):
        (pid,) = [pid for pid in children(service[1]) if part in command_of(pid)]
        os.kill(pid, signal.SIGKILL)
    wait_until(lambda: attempts(client, running.id) == 1, what="the service is back")
    assert client.wait(running.id, timeout=60).objective == pytest.approx(58.80767, abs=1e-3)
    assert client.wait(waiting.id, timeout=60).converged
    assert [attempts(client, job.id) for job in (running, waiting)] == [1, 1]


def test_a_stopped_service_hands_back_what_runs(tmp_path: Path) -> None:
    with serving(tmp_path) as (url, _), Client(url) as client:
        job = client.submit(slow_problem())
        wait_until(lambda: attempts(client, job.id) == 1)
    with serving(tmp_path) as (url, _), Client(url) as client:
        wait_until(lambda: attempts(client, job.id) == 2, 3, "it begins at once")
        client.cancel(job.id)


def test_jobs_outlive_the_service_and_nothing_else_does(tmp_path: Path) -> None:
    with serving(tmp_path) as (url, process), Client(url) as client:
        job = client.submit(examples.load("block_min_force"))
        client.wait(job.id, timeout=60)
        parts = children(process.pid)
        assert len(parts) == 3
    assert process.returncode == 0
    assert all(gone(pid) for pid in parts)
    with serving(tmp_path, "--workers", "0") as (url, _), Client(url) as client:
        assert client.result(job.id).converged


def test_the_parts_die_with_a_killed_service(tmp_path: Path) -> None:
    with serving(tmp_path) as (url, process):
        parts = children(process.pid)
        process.kill()
        process.wait(10)
        wait_until(lambda: all(gone(pid) for pid in parts), 15, "the parts have ended")
        with pytest.raises(httpx.TransportError):
            httpx.get(f"{url}/livez", trust_env=False)
