"""Progress on stderr: a live table on a terminal, plain lines anywhere else."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from rich.console import Console, Group
from rich.live import Live
from rich.spinner import Spinner
from rich.table import Table

from footfall.sse import Event
from footfall.summary import number, plural, words

Shown = Callable[[Event], None]

_STAGES = {
    "build": "building the model",
    "solve": "solving",
    "refine": "refining the mesh",
    "certify": "certifying",
    "simulate": "simulating",
}
_PARTS = ("stage ", "guess ", "split ")  # notes on what begins anew, worth a line of their own
_EVERY = 1.0  # seconds between two plain lines about iterations


@contextmanager
def progress(stream: TextIO) -> Iterator[Shown]:
    """A function that shows each event it is given, until the end of the ``with`` block."""
    if not stream.isatty():
        yield _Lines(stream)
        return
    table = _LiveTable()
    console = Console(file=stream)
    with Live(table, console=console, refresh_per_second=10, transient=True):
        yield table


class _Lines:
    """Plain lines: stages, meshes, states, and an iteration now and then."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._last = 0.0

    def __call__(self, event: Event) -> None:
        line = self._line(event)
        if line:
            print(line, file=self._stream, flush=True)

    def _line(self, event: Event) -> str | None:
        data = event.data
        if event.type == "stage":
            return _stage(data)
        if event.type == "mesh":
            return f"mesh {data['mesh'] + 1}: {_mesh_words(data)}"
        if event.type == "homotopy":
            return f"  {_pass_words(data)}"
        if event.type == "state":
            said = "" if data["status"] == "failed" else data.get("message", "")  # an error says it
            return f"job {words(data['status'])}" + (f": {said}" if said else "")
        said = _step_words(event)
        if said and time.monotonic() - self._last >= _EVERY:
            self._last = time.monotonic()
            return f"  {said}"
        return None


class _LiveTable:
    """The meshes so far, and below them what goes on now. Rich draws it again and again."""

    def __init__(self) -> None:
        self._meshes: list[dict[str, Any]] = []
        self._pass = ""
        self._part = ""
        self._stage = "waiting"
        self._iteration = ""
        self._spinner = Spinner("dots")

    def __call__(self, event: Event) -> None:
        if event.type == "stage":
            self._stage = _stage(event.data)
            if self._stage.startswith(_PARTS):
                self._part = f"{self._stage}: "
        elif event.type == "state":
            self._stage = words(event.data["status"])
        elif event.type == "mesh":
            self._meshes.append(event.data)
            self._pass = ""
        elif event.type == "homotopy":
            self._pass = _pass_words(event.data)
        elif said := _step_words(event):
            self._iteration = said

    def __rich__(self) -> Group:
        self._spinner.update(text=f"{self._part}{self._stage}  {self._iteration}")
        table = [self._table()] if self._meshes else []
        last = [self._pass] if self._pass else []
        return Group(*table, *last, self._spinner)

    def _table(self) -> Table:
        table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
        for head in ("mesh", "segments", "max error", "objective", "iterations", "seconds"):
            table.add_column(head, justify="right")
        for mesh in self._meshes:
            table.add_row(
                str(mesh["mesh"] + 1),
                str(mesh["segments"]),
                number(mesh["max_error"], 3),
                number(mesh["objective"], 10),
                str(mesh["nlp_iterations"]),
                f"{mesh['seconds']:.3f}",
            )
        return table


def _stage(data: dict[str, Any]) -> str:
    note = data.get("note") or ""
    if note.startswith(_PARTS):
        return note
    return _STAGES.get(data["stage"], str(data["stage"])) + (f" {note}" if note else "")


def _mesh_words(data: dict[str, Any]) -> str:
    error, goal = number(data["max_error"], 3), number(data["tolerance"], 3)
    return (
        f"{data['segments']} segments, max error {error} (tolerance {goal}), "
        f"objective {number(data['objective'], 10)}, {data['nlp_iterations']} iterations"
    )


def _pass_words(data: dict[str, Any]) -> str:
    return (
        f"relaxed to {number(data['relaxation'], 3)} by {words(data['form'])}: "
        f"{words(data['status'])}, objective {number(data['objective'], 8)}, "
        f"{plural(data['nlp_iterations'], 'iteration')}"
    )


def _step_words(event: Event) -> str:
    data = event.data
    if event.type == "nlp_iteration":
        return f"iteration {data['iteration']}: {_iteration_words(data)}"
    if event.type == "advance":
        happened = f", {plural(data['events'], 'event')}" if data["events"] else ""
        return f"{number(data['time'], 4)} of {number(data['end'], 4)} s{happened}"
    return ""


def _iteration_words(data: dict[str, Any]) -> str:
    return f"objective {number(data['objective'], 8)}, violation {number(data['violation'], 3)}"
