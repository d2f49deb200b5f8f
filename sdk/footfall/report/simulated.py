"""The page of a simulation: the motion, its curves, what happened on the way."""

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

from footfall.report.figures import Figure
from footfall.report.markup import Child, Markup, el, join
from footfall.report.motion import motion_of
from footfall.report.scales import scientific
from footfall.report.sections import again, modes, moving, remarks, section, trajectory
from footfall.report.shell import document
from footfall.report.tables import grid, pairs
from footfall.simulated import EVENT_HEAD, energy_words, event_row
from footfall.summary import plural, words

_STANDING = {
    "finished": "good",
    "stopped": "good",
    "cancelled": "quiet",
    "time_limit": "fair",
    "step_limit": "fair",
}
_ROWS = 200
"""Of a table; an accumulation of impacts has thousands of events."""


def render_simulation(
    result: Mapping[str, Any], simulation: Mapping[str, Any] | None = None
) -> str:
    """One self-contained HTML page about a simulation's result; parameters as ``render``."""
    figures: list[Figure] = []
    motion = motion_of(result)
    phases = [phase for phase in result["phases"] if len(phase["knots"]) > 1]
    body = el(
        "main",
        _header(result),
        remarks(result),
        moving(motion),
        modes(result),
        trajectory({**result, "phases": phases}, None, figures),
        _events(result["events"]),
        _time(result["timing"]),
        again(result, simulation, "simulate"),
    )
    return document(result["name"], body, figures, motion)


def _header(result: Mapping[str, Any]) -> Markup:
    ends = [time for phase in result["phases"] for time in phase["knots"]]
    span = f"{scientific(ends[0], 6)} to {scientific(ends[-1], 6)} s" if ends else None
    energy = result.get("energy")
    found = result.get("mode_sequence") or {}
    facts = {
        "motion": span,
        "events": str(len(result["events"])) if result["events"] else None,
        "modes": str(len(found["modes"])) if found else None,
        "energy": energy_words(energy) if energy else None,
        "time": f"{result['timing']['total']:.2f} s",
    }
    standing = _STANDING.get(result["status"], "bad")
    return el(
        "header",
        el("p", "Footfall simulation", class_="kicker"),
        el("h1", result["name"]),
        el(
            "p",
            el("span", words(result["status"]), class_=f"badge {standing}"),
            el("span", result["message"]),
            class_="status",
        ),
        pairs({name: fact for name, fact in facts.items() if fact is not None}),
    )


def _events(events: Sequence[Mapping[str, Any]]) -> Markup | None:
    if not events:
        return None
    rows: list[list[Child]] = [[*event_row(event, scientific)] for event in islice(events, _ROWS)]
    return section(
        "Events", grid(EVENT_HEAD, rows, numeric={2, 3, 4, 5}), _more(len(events), "event")
    )


def _more(count: int, noun: str) -> Markup | None:
    left = count - _ROWS
    return el("p", f"and {plural(left, f'more {noun}')}", class_="lead") if left > 0 else None


def _time(timing: Mapping[str, Any]) -> Markup:
    facts: dict[str, Child] = {
        part: f"{timing[part]:.3f} s" for part in ("build", "simulate", "total")
    }
    counts = {name: str(timing[name]) for name in ("steps", "evaluations") if timing[name]}
    return section("Time", join(pairs({**facts, **counts})))
