"""Simulations over real HTTP, a real queue server and a real worker; and in this process."""

import json
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import uvicorn

import examples
import footfall
from api.app import create_app
from api.settings import ApiSettings
from footfall import Client, SimulationResult
from footfall.cli import main
from footfall.errors import BadProblem
from schemas.simulated import SimulationResult as Document
from store.ports import Store
from tests.support.motions import height
from tests.support.service import THROW, WorkerProcess, wait_until

Start = Callable[..., WorkerProcess]
Captured = pytest.CaptureFixture[str]

SWING: dict[str, Any] = {
    "name": "double pendulum",
    "system": {
        "kind": "mechanism",
        "bodies": {
            "upper": {"mass": 1.0, "inertia": 0.02, "com": [0, -0.25]},
            "lower": {"mass": 0.8, "inertia": 0.015, "com": [0, -0.25]},
        },
        "joints": {
            "shoulder": {"kind": "revolute", "child": "upper"},
            "elbow": {"kind": "revolute", "parent": "upper", "child": "lower", "at": [0, -0.5]},
        },
    },
    "initial": {"shoulder": 1.5},
    "duration": 1,
}
ENDLESS = THROW | {
    "name": "endless",
    "system": {"kind": "ode", "states": ["x", "v"], "derivatives": {"x": "v", "v": "-1e8*x"}},
    "initial": {"x": 1},
    "duration": 1e6,
}


@pytest.fixture
def url(queue_store: Store) -> Iterator[str]:
    app = create_app(queue_store, ApiSettings())
    server = uvicorn.Server(uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=1))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        wait_until(lambda: server.started)
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        server.should_exit = True
        thread.join()


@pytest.fixture
def client(url: str, start_worker: Start) -> Iterator[Client]:
    start_worker()
    with Client(url) as opened:
        yield opened


def simulated(client: Client, document: dict[str, Any], **options: Any) -> SimulationResult:
    found = client.wait(client.simulate(document).id, timeout=60, **options)
    assert isinstance(found, SimulationResult)
    return found


def write(folder: Path, document: dict[str, Any]) -> str:
    path = folder / "simulation.json"
    path.write_text(json.dumps(document))
    return str(path)


def test_a_throw_comes_back_through_the_service(client: Client) -> None:
    told: list[str] = []
    found = simulated(client, THROW, on_event=lambda event: told.append(event.type))
    assert (found.status, found.converged, found.objective) == ("finished", True, None)
    time = np.linspace(0, 1.5, 7)
    assert found["y"](time) == pytest.approx([height(t) for t in time], abs=1e-9)
    assert "stage" in told
    assert told[-1] == "state"
    assert "finished" in found.summary()


def test_a_mechanism_comes_with_frames_and_an_animated_report(client: Client) -> None:
    job = client.simulate(SWING)
    found = client.wait(job.id, timeout=60)
    frames = found.document["phases"][0]["frames"]
    assert set(frames["bodies"]) == {"upper", "lower"}
    assert len(frames["time"]) == 61
    page = wait_until(lambda: client.report(job.id))
    assert 'id="motion"' in page
    assert client.job(job.id).kind == "simulation"
    assert [one.id for one in client.jobs(kind="simulation")] == [job.id]
    sampled = client.trajectory(job.id, samples=5, fields=["shoulder"])
    assert sampled["simulation/states/shoulder"][0] == pytest.approx(1.5)


def test_a_solution_is_tried_out(client: Client) -> None:
    """Open loop and undisturbed, the block of least effort arrives; with half of its mass, not."""
    solved = client.submit(examples.load("block_min_force"))
    client.wait(solved.id, timeout=60)
    system = examples.load("block_min_force")["phases"][0]["system"]
    again = {"system": system, "controls": {"from_job": solved.id}, "duration": 1}
    found = simulated(client, again)
    first, *_ = system["states"]
    assert float(found[first](1.0)) == pytest.approx(1.0, abs=1e-6)


def test_a_cancel_keeps_the_motion_so_far(client: Client) -> None:
    job = client.simulate(ENDLESS)
    wait_until(lambda: (client.job(job.id).progress or {}).get("time"), 30)
    client.cancel(job.id)
    found = client.wait(job.id, timeout=20)
    assert client.job(job.id).status == "cancelled"
    assert found.status == "cancelled"


def test_its_seconds_are_limited(client: Client) -> None:
    found = simulated(client, ENDLESS | {"limits": {"seconds": 0.5}})
    assert found.status == "time_limit"
    assert not found.converged


def test_a_bad_one_is_refused_by_the_service_and_here(client: Client) -> None:
    wrong = THROW | {"initial": {"z": 1}}
    for attempt in (client.simulate, footfall.simulate):
        with pytest.raises(BadProblem) as caught:
            attempt(wrong)
        assert caught.value.issues[0].pointer == "/initial/z"
    assert client.validate(wrong) == caught.value.issues
    assert client.validate(THROW) == []


def test_the_same_comes_out_in_this_process(client: Client) -> None:
    there, here = simulated(client, SWING).document, footfall.simulate(SWING).document
    for document in (there, here):
        document.pop("timing")
        document.pop("reproduce")
    assert here == there


class TestCommand:
    def test_here_it_prints_the_result_alone(self, tmp_path: Path, capsys: Captured) -> None:
        assert main(["simulate", write(tmp_path, SWING), "--json"]) == 0
        said = capsys.readouterr()
        assert Document.model_validate_json(said.out).status == "finished"
        assert said.out.count("\n") == 1
        assert "simulating" in said.err

    def test_through_a_service_it_does_the_same(
        self, client: Client, tmp_path: Path, capsys: Captured
    ) -> None:
        report, motion = tmp_path / "r.html", tmp_path / "m.svg"
        file = write(tmp_path, SWING)
        more = ["--report", str(report), "--motion", str(motion)]
        assert main(["simulate", file, "--server", client.url, "--json", *more]) == 0
        said = capsys.readouterr()
        assert Document.model_validate_json(said.out).name == "double pendulum"
        assert 'id="motion"' in report.read_text()
        assert motion.read_text().startswith("<svg")
        assert main(["submit", file, "--server", client.url, "--watch"]) == 0
        assert "double pendulum: finished" in capsys.readouterr().out

    def test_what_ends_early_is_3(self, tmp_path: Path, capsys: Captured) -> None:
        limited = write(tmp_path, ENDLESS | {"limits": {"seconds": 0.3}})
        assert main(["simulate", limited]) == 3
        assert "endless: time limit" in capsys.readouterr().out

    def test_a_bad_document_is_2_and_shows_the_place(
        self, tmp_path: Path, capsys: Captured
    ) -> None:
        assert main(["simulate", write(tmp_path, THROW | {"duration": "2*q"})]) == 2
        assert "/duration" in capsys.readouterr().err
        assert main(["validate", write(tmp_path, THROW | {"duration": "2*q"})]) == 2
        assert main(["validate", write(tmp_path, THROW)]) == 0
        assert main(["solve", write(tmp_path, THROW)]) == 2
        assert "footfall simulate" in capsys.readouterr().err
        problem = examples.load("block_min_force")
        assert main(["simulate", write(tmp_path, problem)]) == 2
        assert "footfall solve" in capsys.readouterr().err

    def test_interrupted_it_keeps_what_there_is(self, tmp_path: Path) -> None:
        command = [sys.executable, "-m", "footfall", "simulate", write(tmp_path, ENDLESS), "--json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            assert run.stderr is not None
            while b" of " not in run.stderr.readline():
                assert run.poll() is None
            run.send_signal(signal.SIGINT)
            out, _ = run.communicate(timeout=60)
        assert run.returncode == 130
        assert json.loads(out)["status"] == "cancelled"

    def test_a_kept_result_is_drawn(self, tmp_path: Path, capsys: Captured) -> None:
        kept = tmp_path / "result.json"
        footfall.simulate(SWING).save(kept)
        assert main(["report", str(kept)]) == 0
        assert capsys.readouterr().out.startswith("<!doctype html>")
        picture, motion = tmp_path / "p.svg", tmp_path / "m.svg"
        words = ["report", str(kept), "--picture", str(picture), "--motion", str(motion)]
        assert main(words) == 0
        assert capsys.readouterr().out == ""
        assert picture.read_text().startswith("<svg")
        footfall.simulate(THROW).save(kept)
        assert main(["report", str(kept), "--motion", str(motion)]) == 2
        assert "no frames" in capsys.readouterr().err
