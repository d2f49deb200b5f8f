"""``footfall sweep``."""

import argparse
import json
import sys
from typing import Any

from footfall.cli import codes
from footfall.cli.jobs import client
from footfall.cli.output import note, refuse, show_json
from footfall.client import Client
from footfall.documents import read_json
from footfall.errors import BadFile, BadProblem
from footfall.summary import number, table, words
from footfall.sweeps import Sweep


def sweep(options: argparse.Namespace) -> int:
    """Solve a problem at many places; Ctrl-C cancels and keeps the points that have ended."""
    request = _request(options)
    problem = request.pop("problem")
    try:
        with client(options) as service:
            queued = service.sweep(problem, **request)
            note(f"sweep {queued.id}: {queued.total} points")
            if options.detach:
                return _detached(queued, options)
            try:
                return _deliver(service.wait_sweep(queued.id, on_change=_progress), options)
            except KeyboardInterrupt:
                return _interrupted(service, queued.id, options)
    except BadProblem as error:
        return refuse(error, {**request, "problem": problem}, options)


def _request(options: argparse.Namespace) -> dict[str, Any]:
    """The whole request: the file may be one, or the problem of one."""
    document = read_json(options.file)
    request: dict[str, Any] = document if "problem" in document else {"problem": document}
    if options.grid:
        request["grid"] = dict(map(_axis, options.grid))
    for name in ("multistart", "chunk"):
        if getattr(options, name) is not None:
            request[name] = getattr(options, name)
    if options.cold:
        request["warm"] = False
    return request


def _axis(text: str) -> tuple[str, list[Any]]:
    """``/phases/0/time/final=1,2,3``; a value is JSON, or a text."""
    place, equals, values = text.partition("=")
    if not (equals and values and place.startswith("/")):
        hint = "Write --grid /phases/0/system/parameters/m1=0.5,1,2"
        raise BadFile(f"--grid {text} is not POINTER=VALUE,VALUE,...", hint)
    if values.startswith("["):
        try:
            found = json.loads(values)
        except ValueError as error:
            raise BadFile(f"--grid {text}: the list is not JSON.") from error
        return place, list(found)
    return place, [_value(value.strip()) for value in values.split(",")]


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def _progress(state: Sweep) -> None:
    failed = state.counts["failed"]
    more = f", {failed} failed" if failed else ""
    note(f"{state.done} of {state.total} points have ended{more}")


def _detached(queued: Sweep, options: argparse.Namespace) -> int:
    if options.json:
        show_json(queued.document)
    else:
        print(queued.id)
    return codes.CONVERGED


def _interrupted(service: Client, sweep_id: str, options: argparse.Namespace) -> int:
    note("cancelling; once more leaves the sweep to itself")
    service.cancel_sweep(sweep_id)
    _deliver(service.wait_sweep(sweep_id, timeout=30), options)
    return codes.INTERRUPTED


def _deliver(ended: Sweep, options: argparse.Namespace) -> int:
    """The table, on stderr where stdout is for programs."""
    print(in_words(ended), file=sys.stderr if options.json else sys.stdout)
    if options.json:
        show_json(ended.document)
    return codes.CONVERGED if ended.converged else codes.OTHERWISE


def in_words(ended: Sweep) -> str:
    """A line for each point, and for each distinct minimum of several guesses."""
    seen = dict.fromkeys(place for point in ended.points for place in point["values"])
    places = [place for place in seen if place != "/multistart"]  # that is 1 at every point
    rows = [
        [
            str(point["index"]),
            *(_shown(point["values"].get(place)) for place in places),
            number(point["objective"], 10),
            words(point["solution_status"] or point["status"]),
            number(point["seconds"], 3),
        ]
        for point in ended.points
    ]
    names = [place.rsplit("/", 1)[-1] for place in places]
    parts = [table(["point", *names, "objective", "solution", "seconds"], rows)]
    if ended.minima is not None:
        found = [
            [
                number(one["objective"], 10),
                words(one["verdict"]),
                ", ".join(map(str, one["points"])),
            ]
            for one in ended.minima
        ]
        parts.append("Distinct minima\n" + table(["objective", "verdict", "points"], found))
    return "\n\n".join(parts)


def _shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    text = "" if value is None else value if isinstance(value, str) else json.dumps(value)
    if isinstance(value, dict) and value.get("kind") == "random":
        text = f"random, seed {value.get('seed', 0)}"
    return text if len(text) <= 30 else f"{text[:27]}..."
