"""The way back: the parts' curves as those of the phase that the user posted; and guesses."""

import dataclasses
import itertools
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curves, fit
from schemas.results import CurveGroup, Group, PhaseResult
from solver.switches.split import Plan
from solver.trajectory import Trajectory

Array = NDArray[np.float64]
Item = TypeVar("Item")

_SAME = 1e-9  # relative: nodes that agree so closely where two parts meet are one


def join(plan: Plan, results: Sequence[PhaseResult]) -> list[PhaseResult]:
    """The results of the user's phases, from those of all parts in order."""
    phases = plan.problem.phases
    return [
        _phase(phase.name, parts)
        for phase, parts in zip(phases, by_phase(plan, results), strict=True)
    ]


def by_phase(plan: Plan, items: Sequence[Item]) -> list[list[Item]]:
    """What there is of all parts, as a list for each of the user's phases."""
    remaining = iter(items)
    return [list(itertools.islice(remaining, count)) for count in plan.counts]


def _phase(name: str, parts: Sequence[PhaseResult]) -> PhaseResult:
    if len(parts) == 1:
        return parts[0]
    sums = {
        integral: [part.integrals[integral] for part in parts] for integral in parts[0].integrals
    }
    return PhaseResult(
        name=name,
        knots=[*parts[0].knots, *(knot for part in parts[1:] for knot in part.knots[1:])],
        groups={group: _nodes([part.groups[group] for part in parts]) for group in parts[0].groups},
        curves={
            group: _curves([part.curves[group] for part in parts]) for group in parts[0].curves
        },
        integrals={integral: _sum(values) for integral, values in sums.items()},
    )


def _sum(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) if len(known) == len(values) else None


def _nodes(groups: Sequence[Group]) -> Group:
    """One after the other. A jump repeats the time; where nothing jumps one node is enough."""
    time, values = list(groups[0].time), {name: list(v) for name, v in groups[0].values.items()}
    for group in groups[1:]:
        first = 1 if _meets(time, values, group) else 0
        time += group.time[first:]
        for name, more in group.values.items():
            values[name] += more[first:]
    return Group(time=time, values=values)


def _meets(time: list[float], values: dict[str, list[float | None]], group: Group) -> bool:
    """Whether a group starts with the node that was the last."""
    if not time or not group.time:
        return False
    last = np.array([time[-1], *(column[-1] for column in values.values())], dtype=float)
    first = np.array([group.time[0], *(group.values[name][0] for name in values)], dtype=float)
    return bool(np.all(np.abs(first - last) <= _SAME * (1 + np.abs(last))))


def _curves(groups: Sequence[CurveGroup]) -> CurveGroup:
    joined = concatenated([Curves.from_dict(group.model_dump()) for group in groups])
    return CurveGroup.model_validate(joined.to_dict())


def concatenated(parts: Sequence[Curves]) -> Curves:
    """Curves one after the other, of the highest degree among them."""
    breaks = np.concatenate([parts[0].breaks, *(part.breaks[1:] for part in parts[1:])])
    breaks = np.maximum.accumulate(breaks)  # parts meet to within round-off
    rows = {name: [part[name].coefficients for part in parts] for name in parts[0]}
    return Curves(breaks, {name: _stacked(pieces) for name, pieces in rows.items()})


def _stacked(pieces: Sequence[Array]) -> Array:
    terms = max(piece.shape[1] for piece in pieces)
    padded = [np.pad(piece, [(0, 0), (0, terms - piece.shape[1])]) for piece in pieces]
    return np.concatenate(padded)


def whole(plan: Plan, trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    """The trajectories of the user's phases, from those of all parts in order."""
    return [_whole(parts) for parts in by_phase(plan, trajectories)]


def _whole(parts: Sequence[Trajectory]) -> Trajectory:
    longest = dataclasses.replace(parts[0], end=parts[-1].end)
    return _with_curves(longest, lambda name: concatenated([getattr(p, name) for p in parts]))


def guesses(plan: Plan, trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    """A guess for each part, from the trajectories of the user's phases."""
    return [
        restrict(trajectory, start, end)
        for cut, trajectory in zip(plan.cuts, trajectories, strict=True)
        for start, end in cut.spans
    ]


def restrict(trajectory: Trajectory, start: float, end: float) -> Trajectory:
    """A trajectory between two of its times, in seconds."""
    if (start, end) == (trajectory.start, trajectory.end):
        return trajectory
    within = dataclasses.replace(trajectory, start=start, end=end)
    return _with_curves(within, lambda name: restricted(getattr(trajectory, name), start, end))


def _with_curves(trajectory: Trajectory, curves: Callable[[str], Curves]) -> Trajectory:
    """All curves of a trajectory, whatever they are, made anew from their field's name."""
    fields = [field.name for field in dataclasses.fields(trajectory)]
    made: dict[str, Any] = {
        name: curves(name) for name in fields if isinstance(getattr(trajectory, name), Curves)
    }
    return dataclasses.replace(trajectory, **made)


def restricted(curves: Curves, start: float, end: float) -> Curves:
    """Curves between two of their times: the same polynomials on shorter segments."""
    inner = curves.breaks[(curves.breaks > start) & (curves.breaks < end)]
    breaks = np.concatenate([[start], inner, [end]])
    terms = max((curve.degree for curve in curves.values()), default=0) + 1
    nodes = chebyshev.chebpts1(terms)
    times = breaks[:-1, None] + np.diff(breaks)[:, None] * (nodes + 1) / 2
    values = [curve(times) for curve in curves.values()]
    table = np.moveaxis(np.array(values).reshape(len(values), *times.shape), 0, -1)
    return Curves(breaks, dict(zip(curves, fit(nodes, table), strict=True)))
