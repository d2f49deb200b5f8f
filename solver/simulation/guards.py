"""When does a guard pass zero? Roots of many functions along one step of an integrator.

A guard is positive as long as its mode holds. An integrator's steps are as long as the *states*
allow; a guard may change much faster (003, section 6.3.2). So guards are sampled along the step's
interpolant at a spacing of their own, dips between samples are searched, and what lies between
two samples of different sides is found by repeated subdivision.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.numeric.tape import Array

Bools = NDArray[np.bool_]
Guards = Callable[[Array], Array]
"""Times (k,) -> the guards' values (g, k)."""

PARTS = 16
"""Into which a bracket is cut each round."""


class Sampling(NamedTuple):
    """How closely guards are looked at.

    Attributes
    ----------
    spacing
        The longest time between two samples, s.
    early
        Whether a mode begins here. Then samples crowd at the start, where the first arcs of
        small bounces are.
    """

    spacing: float
    early: bool = False


class Crossing(NamedTuple):
    """The first time at which guards pass zero, and which of them do."""

    time: float
    fired: tuple[int, ...]


def first_crossing(
    guards: Guards, span: tuple[float, float], above: Bools, sampling: Sampling
) -> tuple[Crossing | None, Bools]:
    """The first falling passage of a guard through zero in ``span``.

    Parameters
    ----------
    guards
        Of a time (k,), the values (g, k).
    span
        Start and end.
    above
        (g,): on which side each guard starts. It decides at the start, where values are often
        zero but for round-off.
    sampling
        Where to look.

    Returns
    -------
    The crossing or None, and on which side the guards end.
    """
    times = _times(span, sampling)
    times, values = _with_dips(guards, times, guards(times))
    sides = values >= 0
    sides[:, 0] = above
    falls = np.any(sides[:, :-1] & ~sides[:, 1:], axis=0)
    if not np.any(falls):
        return None, sides[:, -1]
    first = int(np.argmax(falls))
    bracket = (float(times[first]), float(times[first + 1]))
    return _locate(guards, bracket, sides[:, first]), sides[:, -1]


def _times(span: tuple[float, float], sampling: Sampling) -> Array:
    start, end = span
    parts = int(np.ceil((end - start) / sampling.spacing * (1 - 1e-12)))
    times = np.linspace(start, end, max(parts, 1) + 1)
    if sampling.early:
        near = start + (times[1] - start) * 10.0 ** np.arange(-9, 0)
        times = np.concatenate([times[:1], near[near > start], times[1:]])
    return times


def _with_dips(guards: Guards, times: Array, values: Array) -> tuple[Array, Array]:
    """With the lowest points of dips between samples that may reach below zero."""
    middle, left, right = values[:, 1:-1], values[:, :-2], values[:, 2:]
    rise = np.maximum(left - middle, right - middle)
    dips = (middle >= 0) & (left >= middle) & (right >= middle) & (rise > middle)
    more: list[Array] = []
    for guard, place in np.argwhere(dips):
        near = times[place : place + 3]
        for _ in range(4):
            fine = np.linspace(near[0], near[-1], PARTS + 1)
            lowest = int(np.argmin(guards(fine)[guard]))
            near = fine[max(lowest - 1, 0) : lowest + 2]
        more.append(fine[lowest : lowest + 1])
    if not more:
        return times, values
    found = np.unique(np.concatenate([times, *more]))
    return found, guards(found)


def _locate(guards: Guards, bracket: tuple[float, float], above: Bools) -> Crossing:
    """Cut the bracket until only round-off is left; the first guards to fall decide."""
    start, end = bracket
    fired: tuple[int, ...] = ()
    while True:
        times = np.linspace(start, end, PARTS + 1)
        sides = guards(times) >= 0
        sides[:, 0] = above
        falls = sides[:, :-1] & ~sides[:, 1:]
        columns = np.flatnonzero(np.any(falls, axis=0))
        if not len(columns):  # another round-off, for the values come in another batch
            return Crossing(end, fired)
        first = int(columns[0])
        above, fired = sides[:, first], tuple(np.flatnonzero(falls[:, first]).tolist())
        start, end = float(times[first]), float(times[first + 1])
        if end - start <= 4 * np.spacing(max(abs(start), abs(end))):
            return Crossing(end, fired)
