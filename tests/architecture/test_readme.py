"""What the documents tell a reader to type works, as it stands there, in the order it stands."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from footfall.serving import ServeSettings, Service
from tests.architecture.files import ROOT

ADDRESS = "127.0.0.1:8000"
NOT_HERE = re.compile(r"make (test|check|serve|bench)|docker|git clone|cd |footfall serve|sudo")
"""Run by CI or by other tests, or not within the repository; a service runs already, see below."""
DOCUMENTS = ["README.md", "docs/api.md"]


def blocks(document: str, language: str) -> list[str]:
    """The fenced blocks of one language; none if there is no such document."""
    path = ROOT / document
    text = path.read_text() if path.exists() else ""
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def commands(document: str) -> list[str]:
    """The lines after ``$``, each with the lines that it continues on."""
    text = "\n".join(blocks(document, "console"))
    found = re.findall(r"^\$ ((?:.*\\\n)*.*)$", text, re.MULTILINE)
    return [command for command in found if not NOT_HERE.match(command)]


@pytest.fixture(scope="module")
def environment() -> dict[str, str]:
    return os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a running service, to stand in for the documents' own."""
    folder = tmp_path_factory.mktemp("service")
    with Service(ServeSettings(port=0, folder=folder)) as service:
        yield service.url.removeprefix("http://")


@pytest.mark.skipif(not shutil.which("curl"), reason="sudo apt-get install curl")
@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_commands_of_a_document(
    document: str, environment: dict[str, str], address: str
) -> None:
    script = "\n".join(commands(document)).replace(ADDRESS, address)
    assert script
    run = subprocess.run(
        ["bash", "-euxo", "pipefail", "-c", script],
        cwd=ROOT,
        env=environment | {"FOOTFALL_URL": f"http://{address}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


def test_the_programs_of_the_documents(environment: dict[str, str], address: str) -> None:
    for program in (block for document in DOCUMENTS for block in blocks(document, "python")):
        run = subprocess.run(
            [sys.executable, "-W", "error", "-c", program.replace(ADDRESS, address)],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert run.returncode == 0, program + run.stderr
