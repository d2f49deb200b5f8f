"""The command: exit codes, JSON alone on stdout, words with places on stderr."""

import io
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import examples
import footfall
from footfall import local
from footfall.cli import main
from footfall.cli.words import parser
from footfall.errors import MissingServer
from schemas.results import Solution

BAD = {
    "phases": [
        {
            "system": {
                "kind": "ode",
                "states": ["x"],
                "controls": ["u"],
                "derivatives": {"x": "sin(x) + uu*2"},
            },
            "time": {"final": 1},
        }
    ]
}
Captured = pytest.CaptureFixture[str]


def write(folder: Path, document: Any) -> str:
    path = folder / "problem.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return str(path)


@pytest.fixture
def cart_pole(tmp_path: Path) -> str:
    return write(tmp_path, examples.load("cart_pole"))


def test_solve_json_prints_the_result_alone(cart_pole: str, capsys: Captured) -> None:
    assert main(["solve", cart_pole, "--json"]) == 0
    said = capsys.readouterr()
    assert Solution.model_validate_json(said.out).status == "converged"
    assert said.out.count("\n") == 1
    assert "mesh 1: 25 segments" in said.err


def test_solve_writes_the_files_asked_for(cart_pole: str, tmp_path: Path, capsys: Captured) -> None:
    report, output = tmp_path / "new" / "r.html", tmp_path / "r.json"
    assert main(["solve", cart_pole, "--report", str(report), "--output", str(output)]) == 0
    assert report.read_text().startswith("<!doctype html>")
    assert json.loads(output.read_text())["status"] == "converged"
    said = capsys.readouterr().out
    for words in ("Trajectory of swing_up", "Mesh refinement", "verdict: certified"):
        assert words in said


def test_a_result_that_has_not_converged_is_3(tmp_path: Path, capsys: Captured) -> None:
    problem = examples.load("cart_pole") | {"solver": {"max_iterations": 2}}
    assert main(["solve", write(tmp_path, problem), "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["status"] == "iteration_limit"


@pytest.mark.parametrize("command", ["solve", "validate"])
def test_a_bad_problem_is_2_and_shows_the_place(
    command: str, tmp_path: Path, capsys: Captured
) -> None:
    assert main([command, write(tmp_path, BAD)]) == 2
    said = capsys.readouterr()
    assert not said.out
    lines = said.err.splitlines()
    assert "/phases/0/system/derivatives/x: unknown name 'uu'" in lines[0]
    assert lines[1] == "    sin(x) + uu*2"
    assert lines[2] == "             ^"
    assert "hint" in lines[3]


def test_a_named_system_is_solved_here_and_a_job_is_not(tmp_path: Path, capsys: Captured) -> None:
    problem = examples.load("block_min_force")
    problem["phases"][0]["system"] = {"kind": "library", "name": "block_min_force"}
    assert main(["solve", write(tmp_path, problem), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["objective"] == pytest.approx(12)
    for command in ("solve", "validate"):
        named = problem | {"guess": {"from_job": "0" * 32}}
        assert main([command, write(tmp_path, named)]) == 2
        said = capsys.readouterr().err
        assert "/guess/from_job: there are no jobs in this process" in said
        assert "--server URL" in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--grid", "/a"], "POINTER=VALUE"),
        (["--grid", "a=1"], "POINTER=VALUE"),
        (["--grid", "/a=[1"], "the list is not JSON"),
    ],
)
def test_a_grid_that_cannot_be_read_is_2(
    words: list[str], said: str, cart_pole: str, capsys: Captured
) -> None:
    assert main(["sweep", cart_pole, *words]) == 2
    assert said in capsys.readouterr().err


def test_validate_for_programs(tmp_path: Path, capsys: Captured) -> None:
    assert main(["validate", write(tmp_path, BAD), "--json"]) == 2
    document = json.loads(capsys.readouterr().out)
    assert not document["valid"]
    assert document["issues"][0]["column"] == 10


def test_a_good_problem_is_fine(cart_pole: str, capsys: Captured) -> None:
    assert main(["validate", cart_pole]) == 0
    assert capsys.readouterr().out == f"{cart_pole}: fine\n"


def test_what_deserves_a_look_is_told_before_the_solve(tmp_path: Path, capsys: Captured) -> None:
    problem = examples.load("interior_point") | {"linkages": []}
    path = write(tmp_path, problem)
    assert main(["validate", path]) == 0
    assert "warning: /linkages: nothing ties" in capsys.readouterr().out
    assert main(["validate", path, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["valid"], len(document["warnings"])) == (True, 1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a": 1,}', "line 1, column 9"),
        ('{"a": 1,}', "none after the last"),
        ('{"a": NaN}', "NaN is no JSON number"),
        ('{"a": 1, "a": 2}', 'the key "a" comes twice'),
        ("[1]", "a list, not a JSON object"),
        ("", "not JSON"),
        ("[" * 100_000, "nested too deeply"),
    ],
)
def test_a_file_that_is_no_json_is_2(
    text: str, words: str, tmp_path: Path, capsys: Captured
) -> None:
    assert main(["solve", write(tmp_path, text)]) == 2
    assert words in capsys.readouterr().err


def test_missing_files_folders_and_binaries_are_2(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00")
    for path, words in [("none", "no file"), ("", "a directory"), ("binary", "not UTF-8")]:
        assert main(["validate", str(tmp_path / path)]) == 2
        assert words in capsys.readouterr().err


def test_a_dash_reads_standard_input(
    problem: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    stdin = io.TextIOWrapper(io.BytesIO(json.dumps(problem).encode()))
    monkeypatch.setattr(sys, "stdin", stdin)
    assert main(["validate", "-"]) == 0


def test_a_file_that_cannot_be_written_is_told(cart_pole: str, capsys: Captured) -> None:
    assert main(["solve", cart_pole, "--output", "/proc/nowhere/r.json"]) == 2
    said = capsys.readouterr().err
    assert "cannot be written" in said
    assert "solving" not in said  # it is told before the work, not after
    assert main(["solve", cart_pole, "--report", "/"]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_examples_list_and_print(capsys: Captured) -> None:
    assert main(["examples"]) == 0
    listed = {line.split()[0]: line for line in capsys.readouterr().out.splitlines()}
    assert set(examples.names()) < set(listed)
    for word in ("closed_form", "3 phases", "stages"):
        assert word in listed["slip_stl_str"]
    assert listed["double_integrator"].endswith("switches")
    assert main(["examples", "cart_pole"]) == 0
    assert json.loads(capsys.readouterr().out) == examples.load("cart_pole")
    assert main(["examples", "cart_pol"]) == 2
    assert "Did you mean cart_pole?" in capsys.readouterr().err


def test_no_service_is_a_fault_with_a_mend(
    cart_pole: str, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(time, "sleep", lambda _: None)  # the pauses between retries
    for command in (["submit", cart_pole], ["result", "x"], ["jobs"], ["solve", cart_pole]):
        assert main([*command, "--server", "http://127.0.0.1:1", "--json"]) == 1
        said = capsys.readouterr()
        assert not said.out
        assert json.loads(said.err)["error"] == "ConnectionFailed"
        assert "footfall serve" in said.err


@pytest.mark.parametrize("address", ["127.0.0.1:8000", "nowhere"])
def test_what_is_no_address_is_told(address: str, capsys: Captured) -> None:
    assert main(["result", "x", "--server", address]) == 1
    assert "is not the address of a service" in capsys.readouterr().err


def test_doctor_finds_the_engine_and_no_service(capsys: Captured) -> None:
    assert main(["doctor", "--json", "--server", "http://127.0.0.1:1"]) == 0
    found = {item["name"]: item for item in json.loads(capsys.readouterr().out)}
    assert found["engine"]["state"] == "ok"
    assert found["service"]["state"] == "absent"
    assert "serve" in found["service"]["mend"]


def test_a_missing_package_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "solver", None)
    with pytest.raises(MissingServer, match=r"footfall-server\[worker\]"):
        local.solve(examples.load("cart_pole"))


def test_a_taken_port_is_told_with_a_mend(tmp_path: Path, capsys: Captured) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        assert main(["serve", "--port", port, "--data-dir", str(tmp_path)]) == 1
    assert "--port" in capsys.readouterr().err


COMMANDS = ["solve", "validate", "examples", "submit", "watch", "cancel", "result", "jobs", "serve"]


@pytest.mark.parametrize("command", [*COMMANDS, "sweep", "worker", "doctor"])
def test_every_command_has_help_with_an_example(command: str, capsys: Captured) -> None:
    with pytest.raises(SystemExit) as left:
        parser({}).parse_args([command, "--help"])
    assert left.value.code == 0
    said = capsys.readouterr().out
    assert "example:" in said
    assert "--json" in said


def test_words_that_are_not_commands_are_2(capsys: Captured) -> None:
    for words in (["dance"], ["serve", "--port", "x"], ["serve", "--workers", "-1"]):
        with pytest.raises(SystemExit) as left:
            main(words)
        assert left.value.code == 2


def test_the_bare_command_shows_its_help(capsys: Captured) -> None:
    assert main([]) == 2
    assert "start here:" in capsys.readouterr().err


def test_it_tells_its_version(capsys: Captured) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--version"])
    assert left.value.code == 0
    assert capsys.readouterr().out == f"footfall {footfall.__version__}\n"


def test_the_first_ctrl_c_keeps_the_best_iterate(tmp_path: Path) -> None:
    problem = examples.load("cart_pole") | {"refinement": None}
    problem["method"] = {"kind": "trapezoidal", "segments": 5000}
    problem["solver"] = {"tolerance": 1.1e-14}
    command = [sys.executable, "-m", "footfall", "solve", write(tmp_path, problem), "--json"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ, text=True
    ) as process:
        assert process.stderr is not None
        while "iteration" not in process.stderr.readline():
            time.sleep(0)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert Solution.model_validate_json(out).status == "cancelled"
