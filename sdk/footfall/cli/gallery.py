"""``footfall examples``."""

import argparse
import difflib
import json
from collections.abc import Mapping
from typing import Any

from footfall import local
from footfall.cli import codes
from footfall.cli.output import note, show_json
from footfall.client import Client
from footfall.documents import is_simulation
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
        rows = [[entry["name"], entry["title"], entry.get("uses", "")] for entry in entries]
        head = ["example", "what it is", "what it shows"]
        kept = 3 if any(row[2] for row in rows) else 2  # a service does not tell what it shows
        print(table(head[:kept], [row[:kept] for row in rows], left=kept))
        note("'footfall examples NAME' prints one, with its description and what is known of it")
    return codes.CONVERGED


def uses(problem: Mapping[str, Any]) -> list[str]:
    """What of the language a problem shows: systems, methods, and what not every problem has."""
    if is_simulation(problem):
        method = problem.get("method") or {}
        return ["simulation", problem["system"]["kind"], method.get("kind", "smooth")]
    phases = problem["phases"]
    systems = dict.fromkeys(phase["system"]["kind"] for phase in phases)
    own = [phase["method"] for phase in phases if phase.get("method")]
    methods = dict.fromkeys(
        method["kind"] for method in [problem.get("method") or {}, *own] if method
    )
    more = {
        f"{len(phases)} phases": len(phases) > 1,
        "static": problem.get("static"),
        "residual": any(phase["system"].get("residual") for phase in phases),
        "abs": problem.get("nonsmooth"),
        "switches": (problem.get("refinement") or {}).get("switches"),
        "stages": problem.get("stages"),
        "multistart": problem.get("multistart", 1) > 1,
    }
    plain = ("ode", "hermite_simpson")  # as nearly everywhere
    named = [kind for kind in [*systems, *methods] if kind not in plain]
    return named + [word for word, there in more.items() if there]


def _all(options: argparse.Namespace) -> list[dict[str, Any]]:
    if options.server:
        with _client(options) as client:
            return client.examples()
    return [
        {
            "name": name,
            "title": problem["name"],
            "description": problem.get("description", ""),
            "uses": ", ".join(uses(problem)),
        }
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
