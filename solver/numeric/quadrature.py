"""Gauss-Legendre quadrature over the segments of published curves: fixed, or adaptive."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from solver.numeric.curves import Index, PhaseCurves, Samples
from solver.numeric.tape import Array

POINTS = 10
"""Points a panel of the adaptive rule: exact to degree 19."""

SMALLEST = 1e-12
"""Of a segment: panels are not cut below this, which is where a jump ends."""

MAX_PANELS = 50_000
"""Panels that may be open at once; an integrand that needs more has no trustworthy value."""


@functools.cache
def gauss(points: int, panels: int = 1) -> tuple[Array, Array]:
    """Nodes and weights on [-1, 1], exact to degree 2 * points - 1 on each of equal panels."""
    nodes, weights = legendre.leggauss(points)
    middles = (2 * np.arange(panels) + 1) / panels - 1
    return (middles[:, None] + nodes / panels).ravel(), np.tile(weights / panels, panels)


@dataclass(frozen=True, slots=True)
class Integral:
    """Values (rows,) and a bound on the quadrature's own error (rows,)."""

    value: Array
    error: Array


@dataclass(frozen=True, slots=True)
class _Panels:
    """Parts of segments: their ``segment`` (n,), and where in [-1, 1] of it they ``end`` (n, 2)."""

    segment: Index
    ends: Array

    @classmethod
    def whole(cls, segments: int) -> Self:
        return cls(np.arange(segments), np.tile([-1.0, 1.0], (segments, 1)))

    def halved(self, which: NDArray[np.bool_]) -> Self:
        """Both halves of some panels, side by side."""
        low, high = self.ends[which].T
        cuts = np.stack([low, (low + high) / 2, (low + high) / 2, high], axis=1)
        return type(self)(np.repeat(self.segment[which], 2), cuts.reshape(-1, 2))


@np.errstate(invalid="ignore", over="ignore")
def integrate(
    curves: PhaseCurves, integrand: Callable[[Samples], Array], tolerance: float = 1e-12
) -> Integral:
    """Integrate over time, halving panels until the halves agree with the whole.

    Parameters
    ----------
    integrand
        From n samples to values (rows, n); kinks and jumps only cost panels around them.
    tolerance
        Of each panel, relative to one plus the size of its row's integral.
    """
    panels = _Panels.whole(curves.segments)
    whole = _rule(curves, integrand, panels)
    value, error = np.zeros(len(whole)), np.zeros(len(whole))
    scale = tolerance * (1 + np.abs(whole.sum(axis=1, keepdims=True)))
    unsettled = np.ones(curves.segments, dtype=bool)
    while unsettled.any() and unsettled.sum() <= MAX_PANELS:
        panels = panels.halved(unsettled)
        halves = _rule(curves, integrand, panels)
        pairs = halves[:, ::2] + halves[:, 1::2]
        gap = np.abs(pairs - whole)
        # NaN compares false: a panel that has no value will not get one by halving.
        again = np.any(gap > scale, axis=0) & (np.ptp(panels.ends, axis=1)[::2] > SMALLEST)
        value += pairs[:, ~again].sum(axis=1)
        error += gap[:, ~again].sum(axis=1)
        unsettled = np.repeat(again, 2)
        whole = halves[:, unsettled]
    return Integral(value + whole.sum(axis=1), error + np.abs(whole).sum(axis=1))


def _rule(curves: PhaseCurves, integrand: Callable[[Samples], Array], panels: _Panels) -> Array:
    """The integral over each panel, (rows, panels)."""
    nodes, weights = gauss(POINTS)
    middle, half = panels.ends.mean(axis=1), np.diff(panels.ends, axis=1)[:, 0] / 2
    s = middle[:, None] + half[:, None] * nodes
    values = integrand(curves.at(np.repeat(panels.segment, POINTS), s.ravel()))
    sums = values.reshape(len(values), len(half), POINTS) @ weights
    return np.asarray(sums * half * curves.lengths[panels.segment] / 2)
