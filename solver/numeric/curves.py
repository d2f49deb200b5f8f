"""The published curves of a phase, segment by segment, so that both limits of a break are seen."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curves, fit
from schemas.phases import Phase
from schemas.results import CurveGroup, PhaseResult
from solver.numeric.tape import Array

Index = NDArray[np.intp]


class MalformedCurves(ValueError):
    """The curves of a result cannot be read; the message says which and why."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Chebyshev coefficients of some series, shape (series, segments, degree + 1)."""

    coefficients: Array

    def grid(self, s: Array) -> Array:
        """Values (series, segments, points) at the same places s (points,) in every segment."""
        basis = chebyshev.chebvander(s, self.coefficients.shape[2] - 1)
        return np.asarray(self.coefficients @ basis.T, dtype=np.float64)

    def at(self, segment: Index, s: Array) -> Array:
        """Values (series, n) at places s (n,) in [-1, 1], each in its own segment (n,)."""
        coefficients = self.coefficients[:, segment].transpose(2, 0, 1)
        return np.asarray(chebyshev.chebval(s, coefficients, tensor=False), dtype=np.float64)

    def slopes(self) -> "Pieces":
        """The derivatives with respect to s."""
        return Pieces(np.asarray(chebyshev.chebder(self.coefficients, axis=2), dtype=np.float64))


@dataclass(frozen=True, slots=True)
class Samples:
    """Points of a phase: time (n,), states (n_x, n), controls (n_u, n)."""

    t: Array
    x: Array
    u: Array


@dataclass(frozen=True, slots=True)
class PhaseCurves:
    """States and controls over the segments between ``breaks`` (segments + 1,), in seconds."""

    breaks: Array
    states: Pieces
    controls: Pieces

    @classmethod
    def read(cls, phase: Phase, result: PhaseResult) -> Self:
        """The curves of a result, on the union of the breaks of states and controls.

        Raises
        ------
        MalformedCurves
            If a series is missing, its pieces do not fit the breaks, or the spans differ.
        """
        x = _curves(result.curves.get("states"), phase.system.states, "states")
        if not phase.system.controls:
            return cls(x.breaks, _pieces(x, x.breaks), Pieces(np.empty((0, len(x.breaks) - 1, 1))))
        u = _curves(result.curves.get("controls"), phase.system.controls, "controls")
        if not np.allclose(x.breaks[[0, -1]], u.breaks[[0, -1]], rtol=1e-12, atol=1e-12):
            raise MalformedCurves("states and controls are not over the same span of time")
        breaks = x.breaks
        if not np.array_equal(x.breaks, u.breaks):
            inner = u.breaks[(u.breaks > breaks[0]) & (u.breaks < breaks[-1])]
            breaks = np.union1d(breaks, inner)
        return cls(breaks, _pieces(x, breaks), _pieces(u, breaks))

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.breaks) - 1

    @property
    def lengths(self) -> Array:
        """The segments' lengths in seconds, (segments,)."""
        return np.diff(self.breaks)

    def time(self, segment: Index, s: Array | float) -> Array:
        """The times of places s in [-1, 1] of segments; the two are broadcast."""
        return np.asarray(self.breaks[segment] + self.lengths[segment] * (s + 1) / 2)

    def grid(self, s: Array) -> Samples:
        """The same places s (points,) in every segment, flat: n = segments * points."""
        t = self.time(np.arange(self.segments)[:, None], s)
        x, u = (
            values.reshape(len(values), t.size)
            for values in (self.states.grid(s), self.controls.grid(s))
        )
        return Samples(t.ravel(), x, u)

    def knots(self) -> Array:
        """The states at the breaks, (states, segments + 1): where each segment starts, the end."""
        ends = self.states.grid(np.array([-1.0, 1.0]))
        return np.concatenate([ends[:, :, 0], ends[:, -1:, 1]], axis=1)

    def at(self, segment: Index, s: Array) -> Samples:
        """Places s (n,), each in its own segment (n,)."""
        x, u = self.states.at(segment, s), self.controls.at(segment, s)
        return Samples(self.time(segment, s), x, u)


def _curves(group: CurveGroup | None, names: Sequence[str], label: str) -> Curves:
    if group is None:
        raise MalformedCurves(f"there are no curves of the {label}")
    missing = [name for name in names if name not in group.coefficients]
    if missing:
        raise MalformedCurves(f"the {label} have no curve of {', '.join(missing)}")
    try:
        return Curves(
            group.breaks, {name: np.array(group.coefficients[name], dtype=float) for name in names}
        )
    except ValueError as error:
        raise MalformedCurves(f"the curves of the {label} cannot be read: {error}") from error


def _pieces(curves: Curves, breaks: Array) -> Pieces:
    """All series of a group, padded to one degree, on the same breaks or on finer ones."""
    terms = max(curve.degree for curve in curves.values()) + 1
    if np.array_equal(curves.breaks, breaks):
        rows = [curve.coefficients for curve in curves.values()]
        return Pieces(np.array([np.pad(row, [(0, 0), (0, terms - row.shape[1])]) for row in rows]))
    nodes = chebyshev.chebpts1(terms)
    times = breaks[:-1, None] + np.diff(breaks)[:, None] * (nodes + 1) / 2
    values = np.stack([curve(times) for curve in curves.values()], axis=2)
    return Pieces(fit(nodes, values))
