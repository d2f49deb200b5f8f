"""Sweeps over real HTTP, a real queue server and real workers; also when workers die."""

import json
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import uvicorn

import examples
from api.app import create_app
from api.settings import ApiSettings
from footfall import Client, Sweep
from footfall.cli import main
from footfall.errors import BadProblem, NoResult, ResultNotReady, UnknownSweep
from schemas.events import PointEnded
from store.ports import Store
from tests.support.service import BLOCK, WorkerProcess, wait_until

Start = Callable[..., WorkerProcess]
FINAL = "/phases/0/time/final"
TIMES = [1 + 0.25 * k for k in range(12)]
KEYS = {"key-of-ann-0123456789": "ann", "key-of-bob-0123456789": "bob"}


@pytest.fixture
def keys() -> dict[str, str]:
    return {}


@pytest.fixture
def url(queue_store: Store, keys: dict[str, str]) -> Iterator[str]:
    app = create_app(queue_store, ApiSettings(keys=keys, stop_grace=0.3))
    server = uvicorn.Server(uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=1))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        wait_until(lambda: server.started)
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        server.should_exit = True
        thread.join()


@pytest.fixture
def client(url: str) -> Iterator[Client]:
    with Client(url) as opened:
        yield opened


def ends(store: Store, sweep: Sweep) -> Counter[int]:
    """How often each point has ended, as the logs of the jobs tell."""
    jobs = {point["links"]["job"].rsplit("/", 1)[1] for point in sweep.points}
    events = [logged.event for job_id in jobs for logged in store.events.read(job_id)]
    return Counter(event.index for event in events if isinstance(event, PointEnded))


def cold(client: Client, name: str = "block", **options: Any) -> Sweep:
    """The block over twelve lengths of time; the scripted engine acts by its name."""
    return client.sweep({**BLOCK, "name": name}, grid={FINAL: TIMES}, warm=False, **options)


def test_twelve_points_over_two_workers(
    queue_store: Store, client: Client, start_worker: Start
) -> None:
    """The block's effort is 12 / T^3."""
    workers = {start_worker().name, start_worker().name}
    queued = cold(client)
    sweep = client.wait_sweep(queued.id, timeout=60)
    assert (sweep.status, sweep.converged, sweep.done) == ("succeeded", True, 12)
    for point, final in zip(sweep.points, TIMES, strict=True):
        assert point["values"] == {FINAL: final}
        assert point["objective"] == pytest.approx(12 / final**3, rel=1e-6)
        assert point["verdict"] == "certified"
    result = client.point(sweep.id, 11)
    assert result.objective == sweep.points[11]["objective"]
    jobs = queue_store.jobs.many(queue_store.sweeps.get(sweep.id).jobs)
    assert {job.worker for job in jobs if job} == workers
    assert ends(queue_store, sweep) == Counter(range(12))


def test_kill_9_in_the_middle_loses_and_doubles_no_point(
    queue_store: Store, client: Client, start_worker: Start, tmp_path: Path
) -> None:
    gate = tmp_path / "gate"
    first, second = (start_worker(engine="scripted", gate=str(gate)) for _ in range(2))
    names = ["quick", "quick", "gated", "quick", "quick", "quick"] * 2
    queued = client.sweep(BLOCK, points=[{"/name": name} for name in names])
    wait_until(lambda: client.sweep_state(queued.id).counts["running"] == 2)
    wait_until(lambda: client.sweep_state(queued.id).done == 4)
    first.kill()
    gate.touch()
    sweep = client.wait_sweep(queued.id, timeout=30)
    assert (sweep.status, sweep.counts["succeeded"]) == ("succeeded", 12)
    assert ends(queue_store, sweep) == Counter(range(12))
    jobs = [job for job in queue_store.jobs.many(queue_store.sweeps.get(sweep.id).jobs) if job]
    assert sorted(job.attempts for job in jobs) == [1, 2]
    assert {job.worker for job in jobs} == {second.name}
    begun = queue_store.sweeps.points(sweep.id).begun
    assert sum(begun.values()) == 13  # only the point it was at was begun again


def test_a_point_that_kills_its_process_takes_no_other_along(
    client: Client, start_worker: Start
) -> None:
    start_worker(engine="scripted")
    problem = {**BLOCK, "name": "quick"}
    names = ["quick", "deadly", "quick", "broken", "quick"]
    queued = client.sweep(problem, points=[{"/name": name} for name in names])
    sweep = client.wait_sweep(queued.id, timeout=30)
    assert sweep.status == "failed"
    assert [point["status"] for point in sweep.points] == [
        "succeeded", "failed", "succeeded", "failed", "succeeded",
    ]  # fmt: skip
    assert sweep.points[1]["error"]["type"] == "worker-killed"
    assert sweep.points[3]["error"]["type"] == "engine-fault"
    with pytest.raises(NoResult, match="broke"):
        client.point(sweep.id, 3)


def test_cancel_keeps_what_has_ended(
    queue_store: Store, client: Client, start_worker: Start, tmp_path: Path
) -> None:
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    problem = {**BLOCK, "name": "quick"}
    names = ["quick", "quick", "gated", "quick"]
    queued = client.sweep(problem, points=[{"/name": name} for name in names])
    wait_until(lambda: client.sweep_state(queued.id).points[2]["status"] == "running")
    with pytest.raises(ResultNotReady):
        client.point(queued.id, 2)
    began = time.monotonic()
    client.cancel_sweep(queued.id)
    sweep = client.wait_sweep(queued.id, timeout=10)
    assert time.monotonic() - began < 3
    assert sweep.status == "cancelled"
    assert [point["status"] for point in sweep.points] == ["succeeded"] * 2 + ["cancelled"] * 2
    assert client.point(sweep.id, 2).status == "cancelled"  # its best iterate
    job_id = sweep.points[0]["links"]["job"].rsplit("/", 1)[1]
    client.delete_sweep(sweep.id)
    with pytest.raises(UnknownSweep):
        client.sweep_state(sweep.id)
    assert queue_store.jobs.many([job_id]) == [None]
    assert queue_store.sweeps.result(sweep.id, 0) is None


def test_a_solve_that_does_not_listen_is_killed(
    client: Client, start_worker: Start, tmp_path: Path
) -> None:
    start_worker(engine="scripted", gate=str(tmp_path / "gate"))
    queued = client.sweep({**BLOCK, "name": "deaf"}, grid={FINAL: [1, 2]})
    wait_until(lambda: client.sweep_state(queued.id).counts["running"])
    client.cancel_sweep(queued.id)
    assert client.wait_sweep(queued.id, timeout=5).counts["cancelled"] == 2


def test_the_same_key_makes_one_sweep(queue_store: Store, client: Client) -> None:
    first = cold(client, idempotency_key="once")
    assert cold(client, idempotency_key="once").id == first.id
    assert [one.id for one in client.sweeps()] == [first.id]
    assert len(queue_store.queue.waiting()) == 2


@pytest.mark.parametrize("keys", [KEYS])
def test_owners_see_only_their_own(url: str, start_worker: Start) -> None:
    start_worker(engine="scripted")
    ann, bob = (Client(url, key) for key in KEYS)
    with ann, bob:
        sweep = cold(ann, "quick")
        ann.wait_sweep(sweep.id, timeout=20)
        for call in (bob.sweep_state, bob.cancel_sweep, lambda one: bob.point(one, 0)):
            with pytest.raises(UnknownSweep):
                call(sweep.id)
        assert list(bob.sweeps()) == []
        bob.delete_sweep(sweep.id)
        assert ann.point(sweep.id, 0).status == "converged"


def test_several_guesses_find_the_distinct_minima(client: Client, start_worker: Start) -> None:
    start_worker()
    queued = client.sweep(BLOCK, multistart=3)
    sweep = client.wait_sweep(queued.id, timeout=60)
    assert sweep.minima is not None
    (minimum,) = sweep.minima  # the block is convex
    assert minimum["objective"] == pytest.approx(12, rel=1e-6)
    assert (minimum["verdict"], minimum["points"]) == ("certified", [0, 1, 2])


def test_the_command_sweeps(
    url: str, start_worker: Start, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start_worker()
    file = tmp_path / "block.json"
    file.write_text(json.dumps(BLOCK))
    command = ["sweep", str(file), "--grid", f"{FINAL}=1,2", "--server", url]
    assert main(command) == 0
    said = capsys.readouterr()
    assert [line.split()[2] for line in said.out.splitlines()] == ["objective", "12", "1.5"]
    assert "2 of 2 points have ended" in said.err
    assert main([*command, "--json", "--cold"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["counts"]["succeeded"] == 2
    assert "objective" in said.err
    assert main(["sweep", str(file), "--grid", "/phases/0/tim=1", "--server", url]) == 2
    assert "no 'tim'" in capsys.readouterr().err


def cart_pole_iterations(client: Client, problem: dict[str, Any]) -> tuple[str, int]:
    job = client.submit(problem)
    result = client.wait(job.id, timeout=60)
    assert result.converged
    return job.id, sum(mesh["nlp_iterations"] for mesh in result.mesh)


def test_a_warm_start_from_a_job_takes_fewer_iterations(
    client: Client, start_worker: Start
) -> None:
    """From the solution on another mesh."""
    start_worker()
    first, _ = cart_pole_iterations(client, examples.load("cart_pole"))
    other = examples.load("cart_pole") | {"method": {"kind": "hermite_simpson", "segments": 40}}
    _, cold_iterations = cart_pole_iterations(client, other)
    _, warm_iterations = cart_pole_iterations(client, other | {"guess": {"from_job": first}})
    assert warm_iterations < cold_iterations


def test_a_warm_sweep_takes_fewer_iterations_than_a_cold_one(
    client: Client, start_worker: Start
) -> None:
    start_worker()
    grid = {"/phases/0/system/parameters/m2": [0.3, 0.31, 0.32, 0.33]}
    iterations = {}
    for warm in (False, True):
        queued = client.sweep(examples.load("cart_pole"), grid=grid, warm=warm)
        sweep = client.wait_sweep(queued.id, timeout=100)
        assert sweep.converged
        assert [point["warm"] for point in sweep.points] == [False, warm, warm, warm]
        iterations[warm] = sum(point["iterations"] for point in sweep.points)
    assert iterations[True] < iterations[False]


def test_a_library_system_with_other_parameters(client: Client, start_worker: Start) -> None:
    """A lighter pole takes another effort; the named system and the written one are the same."""
    start_worker()
    written = examples.load("cart_pole")
    written["phases"][0]["system"]["parameters"]["m2"] = 0.2
    named = examples.load("cart_pole")
    named["phases"][0]["system"] = {
        "kind": "library",
        "name": "cart_pole",
        "parameters": {"m2": 0.2},
    }
    objectives = []
    for problem in (written, named):
        result = client.wait(client.submit(problem).id, timeout=60)
        objectives.append((result.objective, result.document["reproduce"]["spec_sha256"]))
    assert objectives[0] == objectives[1]
    named["phases"][0]["system"]["parameters"] = {"m5": 0.2}
    with pytest.raises(BadProblem, match="m1, m2, l, g"):
        client.submit(named)


def test_the_command_starts_from_a_job(
    url: str, client: Client, start_worker: Start, tmp_path: Path
) -> None:
    start_worker(engine="scripted")
    file = tmp_path / "block.json"
    file.write_text(json.dumps(BLOCK))
    with pytest.raises(BadProblem, match="from_job"):
        client.submit({**BLOCK, "guess": {"from_job": "0" * 32}})
    assert main(["submit", str(file), "--guess-from", "0" * 32, "--server", url]) == 2
