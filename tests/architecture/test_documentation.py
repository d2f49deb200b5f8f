"""Every setting, endpoint and command is documented, and nothing that does not exist."""

import re
from unittest.mock import MagicMock

from api.app import create_app
from api.settings import ApiSettings
from tests.architecture.files import ROOT, modules, strings, tracked

VARIABLE = re.compile(r"FOOTFALL_[A-Z0-9_]+|REDIS_URL")
OF_COMPOSE = {"REDIS_PASSWORD", "FOOTFALL_PUBLISH"}
OPERATIONS = (ROOT / "docs/operations.md").read_text()


def variables_read() -> set[str]:
    """The environment variables that the code names."""
    return {text for path in modules() for text in strings(path) if VARIABLE.fullmatch(text)}


def test_every_environment_variable_is_documented() -> None:
    rows = set(re.findall(r"^\| `([A-Z0-9_]+)` \|", OPERATIONS, re.MULTILINE))
    assert rows == variables_read()


def test_no_document_or_deployment_names_a_variable_that_nothing_reads() -> None:
    known = variables_read() | OF_COMPOSE
    places = [path for path in tracked() if path.suffix in {".md", ".yml", ".Dockerfile"}]
    unknown = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in [*places, ROOT / ".env.example"]
        for name in VARIABLE.findall(path.read_text())
        if name not in known
    }
    assert not unknown


def test_every_endpoint_is_documented() -> None:
    paths = create_app(MagicMock(), ApiSettings()).openapi()["paths"]
    served = {f"{method.upper()} {path}" for path, methods in paths.items() for method in methods}
    text = (ROOT / "docs/api.md").read_text().replace("{id}", "{job_id}")
    assert set(re.findall(r"^- `([A-Z]+ /\S*)`", text, re.MULTILINE)) == served
