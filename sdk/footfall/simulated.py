"""The result of a simulation in plain text."""

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

from footfall.summary import (
    mode_count,
    modes_in_words,
    number,
    plural,
    table,
    trajectory_table,
    words,
)

_MOST_EVENTS = 40
"""Events that are listed on a terminal; an accumulation of impacts has thousands."""


def simulation_in_words(result: Mapping[str, Any]) -> str:
    """All that a person reads on a terminal: summary, trajectory, events, modes."""
    parts = [("", summarize_simulation(result))]
    parts += [
        ("Trajectory (t in s)\n", trajectory_table(phase))
        for phase in result["phases"]
        if len(phase["knots"]) > 1
    ]
    if result["events"]:
        parts.append(("Events\n", event_table(result["events"])))
    if (result.get("mode_sequence") or {}).get("modes"):
        parts.append(("Modes\n", modes_in_words(result)))
    return "\n\n".join(head + text for head, text in parts)


def summarize_simulation(result: Mapping[str, Any]) -> str:
    """Status, span, events, energy, and what stands out."""
    timing = result["timing"]
    lines = [f"{result['name']}: {words(result['status'])}", f"  {result['message']}"]
    lines += [f"  motion       {_span(phase)}" for phase in result["phases"]]
    if result["events"]:
        lines.append(f"  events       {plural(len(result['events']), 'event')}")
    if result.get("mode_sequence"):
        lines.append(f"  modes        {mode_count(result['mode_sequence'])}")
    if result.get("energy"):
        lines.append(f"  energy       {energy_words(result['energy'])}")
    steps = f", {plural(timing['steps'], 'step')}" if timing["steps"] else ""
    lines.append(f"  time         {timing['total']:.2f} s{steps}")
    lines += [f"  warning: {text}" for text in result.get("warnings", [])]
    lines += [f"  advice: {text}" for text in result.get("advice", [])]
    return "\n".join(lines)


def energy_words(energy: Mapping[str, Any]) -> str:
    """From where to where; and how far it strayed on the way, where nothing drives or brakes."""
    first, last = energy["initial"], energy["final"]
    ends = f"{number(first, 6)} to {number(last, 6)} J"
    if energy["drift"] is not None:
        return f"{ends}, drift {number(energy['drift'], 3)}"
    return ends if first is None or last is None else f"{ends}, change {number(last - first, 6)} J"


def event_table(events: Sequence[Mapping[str, Any]]) -> str:
    """One line for each of the first events."""
    rows = [event_row(event, number) for event in islice(events, _MOST_EVENTS)]
    more = len(events) - len(rows)
    rest = f"\nand {more} more" if more else ""
    return table(EVENT_HEAD, rows, left=2) + rest


EVENT_HEAD = ["event", "of", "t [s]", "normal [N s]", "tangential [N s]", "gap rate [m/s]"]


def event_row(event: Mapping[str, Any], show: Any) -> list[str]:
    """The cells of an event; ``show`` writes a number with so many digits."""
    rates = event.get("gap_rate")
    return [
        words(event["kind"]),
        event["name"],
        show(event["time"], 8),
        show(event.get("normal"), 5),
        show(event.get("tangential"), 5),
        f"{show(rates[0], 4)} to {show(rates[1], 4)}" if rates else "",
    ]


def _span(phase: Mapping[str, Any]) -> str:
    return f"{number(phase['knots'][0], 6)} to {number(phase['knots'][-1], 6)} s"
