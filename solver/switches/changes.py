"""When a sampled signal jumps, and when it changes from one label to another for good."""

import itertools

import numpy as np
from numpy.typing import NDArray

from solver.numeric import Array
from solver.switches.samples import PLACES, Samples

JUMP = 0.1
"""The least jump between neighbouring segments, relative to the signal's range."""

CONTRAST = 4.0
"""How much larger it is than the changes beside it."""

SMEAR = 3
"""Jumps in a row that are one smeared jump; more are a slope."""

LASTING = 3 * PLACES // 2
"""Samples, one segment and a half, that a label lasts at the least to count."""

FLAT = 1e-3
"""A range below this share of the signal's size is noise."""


def jumps(samples: Samples, values: Array, size: float) -> list[float]:
    """The times in seconds at which a signal jumps.

    The steps between the means of neighbouring segments are looked at: adjacent ones of one
    sign, each above a tenth of the range, are one jump where the largest is half of them and more
    than four times what stands on either side. It is placed at the steps' centroid, which keeps
    the integral.

    Parameters
    ----------
    values
        The signal, (segments, PLACES).
    size
        Its typical size; a range far below it is noise.
    """
    span = float(np.ptp(values))
    if not span > FLAT * size:
        return []
    steps = np.diff(values.mean(axis=1))
    large = np.abs(steps) > JUMP * span
    times: list[float] = []
    for first, last in _runs(np.where(large, np.sign(steps), 0.0)):
        if large[first] and last - first <= SMEAR and _stands_out(steps, first, last):
            own = steps[first:last]
            times.append(float(samples.knots[first + 1 : last + 1] @ own / own.sum()))
    return times


def _stands_out(steps: Array, first: int, last: int) -> bool:
    """Whether one step makes up half of them, and is far larger than those beside them.

    There have to be steps beside them: at an end of the phase a slope looks like a jump.
    """
    if first == 0 or last == len(steps):
        return False
    largest = np.max(np.abs(steps[first:last]))
    beside = max(abs(steps[first - 1]), abs(steps[last]))
    return bool(largest >= abs(steps[first:last].sum()) / 2 and largest > CONTRAST * beside)


def changes(samples: Samples, labels: NDArray[np.int_]) -> list[float]:
    """The times in seconds at which a label gives way to another.

    Labels that do not last are on the way from one to the next: the change is in their middle.
    What returns after so short a time has not changed.

    Parameters
    ----------
    labels
        Of every sample, (segments, PLACES).
    """
    flat, edges = labels.ravel(), samples.edges()
    lasting = [(a, b) for a, b in _runs(flat) if b - a >= LASTING]
    return [
        float(edges[end] + edges[start]) / 2
        for (before, end), (start, _) in itertools.pairwise(lasting)
        if flat[before] != flat[start]
    ]


def _runs(values: NDArray[np.int_] | Array) -> list[tuple[int, int]]:
    """First and one past the last index of every stretch of equal values."""
    if not len(values):
        return []
    cuts = np.flatnonzero(np.diff(values)) + 1
    return [(int(a), int(b)) for a, b in zip([0, *cuts], [*cuts, len(values)], strict=True)]
