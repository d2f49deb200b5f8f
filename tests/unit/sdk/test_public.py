"""What users import: all of it exported, documented, and cheap to load."""

import inspect
import subprocess
import sys

import pytest

import footfall


@pytest.mark.parametrize("name", footfall.__all__)
def test_every_public_name_is_there_and_documented(name: str) -> None:
    thing = getattr(footfall, name)
    assert inspect.getdoc(thing)
    if inspect.isclass(thing):
        members = [m for n, m in vars(thing).items() if not n.startswith("_")]
        undocumented = [m for m in members if callable(m) and not inspect.getdoc(m)]
        assert not undocumented


def test_every_home_is_exported() -> None:
    assert set(footfall._HOMES) | {"errors"} == set(footfall.__all__)
    assert dir(footfall) == sorted(footfall.__all__)
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = footfall.no_such_name


def loaded_by(code: str) -> set[str]:
    program = f"import sys; {code}; print(*sys.modules)"
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return {name.partition(".")[0] for name in run.stdout.split()}


def test_importing_footfall_loads_nothing_else() -> None:
    assert not {"numpy", "httpx", "rich", "casadi"} & loaded_by("import footfall")


def test_curves_and_report_load_only_numpy() -> None:
    loaded = loaded_by("from footfall import Curve, render; Curve([0, 1], [[1.0]])")
    assert "numpy" in loaded
    heavy = {"httpx", "rich", "casadi", "schemas", "solver", "api", "scipy", "matplotlib"}
    assert not heavy & loaded


def test_the_client_loads_no_server() -> None:
    server = {"api", "worker", "solver", "schemas", "store", "casadi", "pydantic"}
    assert not server & loaded_by("from footfall import Client; Client()")
