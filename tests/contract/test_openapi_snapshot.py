"""The published surface: paths, methods, status codes. A change must be meant."""

import json
import os
from pathlib import Path
from typing import Any

from api.app import create_app
from api.settings import ApiSettings
from store.memory import connect

SNAPSHOT = Path(__file__).parent / "openapi_snapshot.json"
UPDATE = "FOOTFALL_UPDATE_SNAPSHOT"
HELP = (
    "The HTTP surface changed. Clients rely on it: was it meant, is docs/ told, is the change in "
    f"the changelog? Then run: {UPDATE}=1 pytest {Path(__file__).name}"
)


def document() -> dict[str, Any]:
    return create_app(connect(), ApiSettings()).openapi()


def surface() -> dict[str, dict[str, list[str]]]:
    paths = document()["paths"]
    return {
        path: {method: sorted(call["responses"]) for method, call in sorted(methods.items())}
        for path, methods in sorted(paths.items())
    }


def test_the_surface_is_the_agreed_one() -> None:
    if os.environ.get(UPDATE):
        SNAPSHOT.write_text(json.dumps(surface(), indent=2) + "\n")
    assert surface() == json.loads(SNAPSHOT.read_text()), HELP


def test_every_call_is_described() -> None:
    for path, methods in document()["paths"].items():
        for method, call in methods.items():
            assert call.get("description"), f"{method} {path} has no docstring"
            assert call["tags"]


def test_every_error_is_problem_json() -> None:
    for path, methods in document()["paths"].items():
        for method, call in methods.items():
            for status, reply in call["responses"].items():
                if status >= "4":
                    assert list(reply["content"]) == ["application/problem+json"], (path, method)


def test_every_reference_leads_somewhere() -> None:
    whole = document()
    text = json.dumps(whole)
    names = {part.split('"')[0] for part in text.split("#/components/schemas/")[1:]}
    assert names <= set(whole["components"]["schemas"])
    assert "#/$defs/" not in text
