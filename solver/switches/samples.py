"""A phase's published curves, sampled: the same number of places in every segment."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from schemas.expressions import Tree
from schemas.results import PhaseResult
from solver.lowering import Form
from solver.numeric import Array, MalformedCurves, PhaseCurves, along

PLACES = 6
"""In the middles of as many equal cells of each segment."""


@dataclass(frozen=True, slots=True)
class Samples:
    """Times (segments, PLACES), states and controls (series, segments, PLACES) of a form.

    ``knots`` are those of the mesh in seconds (segments + 1,); ``statics`` the problem's free
    parameters.
    """

    form: Form
    statics: Mapping[str, float]
    knots: Array
    t: Array
    x: Array
    u: Array

    @classmethod
    def of(cls, form: Form, result: PhaseResult, statics: Mapping[str, float]) -> Self | None:
        """Those of a result; None where it has no finite curves."""
        try:
            curves, knots = PhaseCurves.read(form, result), np.array(result.knots)
        except MalformedCurves:
            return None
        cells = (np.arange(PLACES) + 0.5) / PLACES
        t = knots[:-1, None] + np.diff(knots)[:, None] * cells
        piece = np.searchsorted(curves.breaks[1:-1], t.ravel(), side="right")
        s = 2 * (t.ravel() - curves.breaks[piece]) / curves.lengths[piece] - 1
        at = curves.at(piece, s)
        x, u = (values.reshape(len(values), *t.shape) for values in (at.x, at.u))
        known = np.isfinite(x).all() and np.isfinite(u).all()
        return cls(form, statics, knots, t, x, u) if known else None

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.knots) - 1

    def value(self, tree: Tree) -> Array:
        """An expression along the phase, (segments, PLACES); NaN where it has no value."""
        return np.asarray(along(self.form, [tree], self.statics)(self.t, self.x, self.u)[0])

    def edges(self) -> Array:
        """The ends of all cells in seconds, (segments * PLACES + 1,)."""
        shares = np.arange(PLACES) / PLACES
        starts = self.knots[:-1, None] + np.diff(self.knots)[:, None] * shares
        return np.append(starts.ravel(), self.knots[-1])

    def width(self, time: float) -> float:
        """The length in seconds of the longer segment of those at a time; half a mean one at least.

        Where the mesh was refined around a switch its segments say little about what lasts.
        """
        widths = np.diff(self.knots)
        sides = (np.searchsorted(self.knots, time, side) for side in ("left", "right"))
        own = [widths[np.clip(place - 1, 0, self.segments - 1)] for place in sides]
        return float(max(*own, widths.mean() / 2))
