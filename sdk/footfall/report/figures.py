"""What is drawn: series over time with their nodes and limits, and the errors of each mesh."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from footfall.curves import Curve, Floats
from footfall.report.phases import Band, Level, Phase, Track, bands, groups, tracks
from footfall.report.scales import Scale, linear, logarithmic, scientific

TOGETHER = 6
"""Series in one plot: as many as there are colours that are told apart."""

_FINE = 900  # points along one curve, more or less
_MARKS = 1500  # nodes that are marked in one plot, at the most
_FAR = 2.5  # a limit that would stretch the axis more than this stays out of the picture


@dataclass(frozen=True)
class Series:
    """One line: points ``(time, value)``, NaN where it breaks; ``curve`` answers the pointer."""

    label: str
    style: str
    time: Floats
    value: Floats
    curve: Curve
    nodes: tuple[Floats, Floats] | None = None
    limits: tuple[Level, ...] = ()


@dataclass(frozen=True)
class Figure:
    """One plot over time. ``mark`` is a labelled level across it, ``unit`` that of x.

    ``bands`` are the parts of the axis that belong to several phases.
    """

    title: str
    series: list[Series]
    x: Scale
    y: Scale
    mark: tuple[float, str] | None = None
    notes: list[str] = field(default_factory=list)
    unit: str = " s"
    bands: list[Band] = field(default_factory=list)
    group: str = ""


def trajectories(
    phases: Sequence[Phase], problem: Mapping[str, Any] | None = None
) -> Iterator[Figure]:
    """The plots of all phases over one time axis, group by group, with the problem's bounds."""
    for group in groups(phases):
        series = list(tracks(group, phases, problem))
        plots = math.ceil(len(series) / TOGETHER)
        for index in range(plots):  # as many in each as in the others
            first, last = (len(series) * end // plots for end in (index, index + 1))
            yield _trajectory(group, series[first:last], phases)


def mesh_errors(refinement: Mapping[str, Any]) -> Figure | None:
    """The error of each segment, a step line for each mesh; None where no error is known."""
    meshes = [m for m in refinement["iterations"] if any(e for e in m["errors"])]
    if not meshes:
        return None
    tolerance = refinement["tolerance"]
    series = [
        _steps(mesh, _age(position, len(meshes)), refinement["iterations"].index(mesh) + 1)
        for position, mesh in enumerate(meshes)
    ]
    values = [error for mesh in meshes for error in mesh["errors"] if error]
    ends = [time for mesh in meshes for span in mesh["spans"] for time in span]
    return Figure(
        title="Error of each segment",
        series=series,
        x=_time_axis(min(ends), max(ends)),
        y=logarithmic([*values, *([tolerance] if tolerance else [])]),
        mark=(tolerance, f"tolerance {scientific(tolerance, 3)}") if tolerance else None,
    )


def convergence(refinement: Mapping[str, Any]) -> list[Figure]:
    """Largest error and objective from mesh to mesh; nothing for a single mesh."""
    meshes = refinement["iterations"]
    if len(meshes) < 2:
        return []
    count = np.arange(1.0, len(meshes) + 1)
    errors = [mesh["max_error"] for mesh in meshes]
    values = [mesh["objective"] for mesh in meshes]
    tolerance = refinement["tolerance"]
    levels = [*[e for e in errors if e], *([tolerance] if tolerance else [])]
    mark = (tolerance, f"tolerance {scientific(tolerance, 3)}") if tolerance else None
    axis = Scale(0.7, len(meshes) + 0.3, whole=True)
    error = points("largest error", "s0", count, errors)
    objective = points("objective", "s1", count, values)
    height = linear([v for v in values if v is not None], 0.15)
    return [
        Figure("Largest error", [error], axis, logarithmic(levels), mark, unit=""),
        Figure("Objective", [objective], axis, height, unit=""),
    ]


def homotopy(passes: Sequence[Mapping[str, Any]]) -> list[Figure]:
    """Largest product of a pair and objective from pass to pass; nothing for a single one."""
    if len(passes) < 2:
        return []
    count = np.arange(1.0, len(passes) + 1)
    relaxed = [one["relaxation"] for one in passes]
    products = [one["residual"] for one in passes]
    values = [one["objective"] for one in passes]
    axis = Scale(0.7, len(passes) + 0.3, whole=True)
    lines = [
        points("relaxation", "m1", count, relaxed),
        points("largest product of a pair", "s0", count, products),
    ]
    levels = [one for one in [*relaxed, *products] if one is not None]
    objective = points("objective", "s1", count, values)
    height = linear([one for one in values if one is not None], 0.15)
    return [
        Figure(
            "Largest product of a pair",
            lines,
            axis,
            logarithmic(levels),
            notes=["over the passes; pale: the relaxation"],
            unit="",
        ),
        Figure("Objective", [objective], axis, height, notes=["over the passes"], unit=""),
    ]


def points(label: str, style: str, across: Floats, raw: Sequence[float | None]) -> Series:
    """A series that is known at some places only, joined by straight lines."""
    values = np.array(raw, dtype=float)
    still = Curve([across[0], across[-1]], [[0.0]])
    return Series(label, style, across, values, still, (across, values))


def _trajectory(group: str, chunk: Sequence[Track], phases: Sequence[Phase]) -> Figure:
    x = _time_axis(phases[0]["knots"][0], phases[-1]["knots"][-1])
    lines = [_with_jumps(track.curve, _drawing_times(track.curve.breaks)) for track in chunk]
    values = np.concatenate([value for _, value in lines])
    extent = linear(values[np.isfinite(values)].tolist())
    most = max((len(track.nodes[0]) for track in chunk if track.nodes), default=0)
    every = max(1, math.ceil(most / _MARKS))
    series, notes = [], [f"every {every}th node marked"] if every > 1 else []
    far = [t.name for t in chunk if not all(_is_near(level.value, extent) for level in t.levels)]
    if far:
        notes.append(f"some bounds of {', '.join(far)} lie outside of the picture")
    for index, (track, line) in enumerate(zip(chunk, lines, strict=True)):
        near = tuple(level for level in track.levels if _is_near(level.value, extent))
        marked = (track.nodes[0][::every], track.nodes[1][::every]) if track.nodes else None
        series.append(Series(track.name, f"s{index}", *line, track.curve, marked, near))
    levels = [level.value for item in series for level in item.limits]
    y = linear([extent.low, extent.high, *levels], 0.04) if levels else extent
    title = group.capitalize()
    return Figure(title, series, x, y, notes=notes, bands=bands(phases), group=group)


def _drawing_times(breaks: Floats) -> Floats:
    segments = len(breaks) - 1
    if segments > _FINE:
        return np.linspace(breaks[0], breaks[-1], 2 * _FINE)
    inside = max(2, math.ceil(_FINE / segments / 2))
    share = np.arange(inside) / inside
    return np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * share).ravel(), breaks[-1])


def _with_jumps(curve: Curve, times: Floats) -> tuple[Floats, Floats]:
    """The line's points, with a break wherever the curve jumps; steps are stairs."""
    inner = curve.breaks[1:-1]
    before, after = curve(inner, side="left"), curve(inner)
    known = curve(times)
    known = known[np.isfinite(known)]
    height = np.ptp(known) if len(known) else 0.0
    ends = np.isfinite(before) != np.isfinite(after)
    jumps = ends | (np.abs(after - before) > 1e-3 * max(height, 1e-12))
    where = inner[jumps]
    stairs = not np.nan_to_num(curve.coefficients[:, 1:]).any()
    lifted = where[:0] if stairs else where
    time = np.concatenate([times, where, lifted])
    value = np.concatenate([curve(times), before[jumps], np.full(len(lifted), np.nan)])
    kinds = (np.full(len(times), 2), np.zeros(len(where)), np.ones(len(lifted)))
    order = np.lexsort((np.concatenate(kinds), time))
    return time[order], value[order]


def _is_near(level: float, extent: Scale) -> bool:
    low, high = min(level, extent.low), max(level, extent.high)
    return high - low <= _FAR * (extent.high - extent.low)


def _steps(mesh: Mapping[str, Any], style: str, number: int) -> Series:
    spans = np.asarray(mesh["spans"], dtype=float).reshape(-1, 2)
    errors = np.array(mesh["errors"], dtype=float)
    time = np.column_stack([spans, spans[:, 1]]).ravel()
    gaps = np.r_[spans[1:, 0] != spans[:-1, 1], False]
    after = np.where(gaps, np.nan, errors)
    value = np.column_stack([errors, errors, after]).ravel()
    curve = Curve(np.append(spans[:, 0], spans[-1, 1]), errors[:, None])
    return Series(f"mesh {number}, {len(spans)} segments", style, time, value, curve)


def _age(position: int, count: int) -> str:
    """Old meshes are pale, the last one is strong: five shades."""
    return f"m{4 - min(4, count - 1 - position)}"


def _time_axis(start: float, end: float) -> Scale:
    return Scale(float(start), float(end) if end > start else float(start) + 1.0)
