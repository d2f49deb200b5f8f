"""Several phases over one time axis: their groups joined, their bounds and names kept apart."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from footfall.curves import Curve, Floats
from footfall.report.limits import limits_of

Phase = Mapping[str, Any]

COSTATES = "costates"
"""The group whose series have the states' names, but are no states."""

IMPULSES = "impulses"
"""The group whose series have the forces' names; each value belongs to the step that it ends."""

_LABELS = {COSTATES: "costate of {}", IMPULSES: "impulse of {}"}


@dataclass(frozen=True)
class Band:
    """A phase's part of the time axis, from ``start`` to ``end`` in s."""

    name: str
    start: float
    end: float


@dataclass(frozen=True)
class Level:
    """A bound that is a number, from ``start`` to ``end`` in s."""

    value: float
    start: float
    end: float


@dataclass(frozen=True)
class Track:
    """A series over all phases: undefined (NaN) where a phase does not have it.

    ``nodes`` are its times and values at the nodes, None where the result has none.
    """

    name: str
    curve: Curve
    nodes: tuple[Floats, Floats] | None
    levels: tuple[Level, ...]


def bands(phases: Sequence[Phase]) -> list[Band]:
    """The phases that are told apart in a picture: none where there is only one."""
    if len(phases) < 2:
        return []
    return [Band(p["name"], *_span(p)) for p in phases]


def groups(phases: Sequence[Phase]) -> list[str]:
    """The names of all groups that have series, in the order of their first appearance."""
    named = ([*phase["curves"], *phase["groups"]] for phase in phases)
    return list(dict.fromkeys(name for names in named for name in names))


def tracks(
    group: str, phases: Sequence[Phase], problem: Mapping[str, Any] | None
) -> Iterator[Track]:
    """The series of one group, each over all phases."""
    bounded = None if group in (COSTATES, IMPULSES) else problem
    limits = [limits_of(bounded, phase["name"]) for phase in phases]
    known = [_names(group, phase) for phase in phases]
    for name in dict.fromkeys(name for names in known for name in names):
        levels = tuple(
            Level(value, *_span(phase))
            for phase, bounds, names in zip(phases, limits, known, strict=True)
            if name in names
            for value in bounds.get(name, ())
        )
        label = _LABELS.get(group, "{}").format(name)
        yield Track(label, _joined(group, name, phases), _nodes(group, name, phases), levels)


def _names(group: str, phase: Phase) -> list[str]:
    drawn = phase["curves"].get(group, {}).get("coefficients", {})
    marked = phase["groups"].get(group, {}).get("values", {})
    return [*drawn, *(name for name in marked if name not in drawn)]


def _joined(group: str, name: str, phases: Sequence[Phase]) -> Curve:
    """The curves of all phases behind one another, padded to one degree; NaN in the gaps."""
    pieces = [piece for phase in phases if len((piece := _piece(group, name, phase))[0]) > 1]
    degree = max(rows.shape[1] for _, rows in pieces)
    breaks, blocks = [pieces[0][0][0]], []
    for times, rows in pieces:
        if times[0] > breaks[-1]:
            breaks.append(times[0])
            blocks.append(np.full((1, degree), np.nan))
        breaks += np.maximum(times[1:], breaks[-1]).tolist()
        blocks.append(np.pad(rows, ((0, 0), (0, degree - rows.shape[1]))))
    return Curve(breaks, np.concatenate(blocks))


def _piece(group: str, name: str, phase: Phase) -> tuple[Floats, Floats]:
    """One phase's breaks and coefficients: of its curve, of straight lines between its nodes."""
    curves, nodes = phase["curves"].get(group, {}), phase["groups"].get(group, {})
    if name in curves.get("coefficients", {}):
        rows = np.array(curves["coefficients"][name], dtype=float)
        return np.asarray(curves["breaks"], dtype=float), rows
    if name in nodes.get("values", {}):
        value = np.array(nodes["values"][name], dtype=float)
        if group == IMPULSES:
            return np.asarray(phase["knots"], dtype=float), value[:, None]
        rows = np.column_stack([value[:-1] + value[1:], value[1:] - value[:-1]]) / 2
        return np.asarray(nodes["time"], dtype=float), rows
    return np.array(_span(phase)), np.full((1, 1), np.nan)


def _nodes(group: str, name: str, phases: Sequence[Phase]) -> tuple[Floats, Floats] | None:
    found = [
        (nodes["time"], nodes["values"][name])
        for phase in phases
        if (nodes := phase["groups"].get(group)) and name in nodes["values"]
    ]
    if not found:
        return None
    times, values = zip(*found, strict=True)
    return np.array([*chain(*times)], dtype=float), np.array([*chain(*values)], dtype=float)


def _span(phase: Phase) -> tuple[float, float]:
    return float(phase["knots"][0]), float(phase["knots"][-1])
