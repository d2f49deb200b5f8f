"""``footfall examples``."""

import argparse
import difflib
import json
import shutil
from textwrap import shorten
from typing import Any

from footfall import local
from footfall.cli import codes
from footfall.cli.output import show_json
from footfall.client import Client
from footfall.errors import BadFile
from footfall.summary import table


def examples(options: argparse.Namespace) -> int:
    """List the gallery, or print one of its problems as JSON."""
    if options.name:
        problem = _one(options)
        print(json.dumps(problem, indent=None if options.json else 2, ensure_ascii=False))
        return codes.CONVERGED
    entries = _all(options)
    if options.json:
        show_json(entries)
    else:
        room = shutil.get_terminal_size().columns - 2 - max(len(entry["name"]) for entry in entries)
        rows = [
            [entry["name"], shorten(entry["description"], max(room, 40), placeholder=" ...")]
            for entry in entries
        ]
        print(table(["example", "what it is"], rows, left=2))
    return codes.CONVERGED


def _all(options: argparse.Namespace) -> list[dict[str, Any]]:
    if options.server:
        with _client(options) as client:
            return client.examples()
    return [
        {"name": name, "title": problem["name"], "description": problem.get("description", "")}
        for name, problem in local.examples().items()
    ]


def _one(options: argparse.Namespace) -> dict[str, Any]:
    if options.server:
        with _client(options) as client:
            return client.example(options.name)
    found = local.examples()
    if options.name not in found:
        near = difflib.get_close_matches(options.name, found, 1)
        hint = f"Did you mean {near[0]}?" if near else "'footfall examples' lists them."
        raise BadFile(f"There is no example {options.name}.", hint)
    return found[options.name]


def _client(options: argparse.Namespace) -> Client:
    return Client(options.server, options.environment.get("FOOTFALL_KEY"))
