"""A phase's trajectory as piecewise polynomials: a guess, or what a solve ended with."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curve, Curves

Array = NDArray[np.float64]


def _no_curves() -> Curves:
    return Curves([0.0, 1.0], {})


@dataclass(frozen=True, slots=True)
class Trajectory:
    """States and controls as curves over time in seconds, from ``start`` to ``end``.

    ``others`` are series without a name of the user's, such as slacks.
    """

    start: float
    end: float
    states: Curves
    controls: Curves
    others: Curves = field(default_factory=_no_curves)

    def curve(self, name: str) -> Curve | None:
        """A series by name; a derivative that is none is taken of its curve. None: unknown."""
        for group in (self.states, self.controls, self.others):
            if name in group:
                return group[name]
        if not name.endswith(")"):
            return None
        order, _, inner = name[:-1].partition("(")
        lower = f"{order[1:]}({inner})" if len(order) > 1 else inner
        known = self.curve(lower)
        return None if known is None else known.derivative()

    def sample(self, names: Sequence[str], fractions: Array) -> Array:
        """Series at fractions of the duration, shape (names, *fractions.shape).

        ``initial.NAME`` is a series' value at the start; unknown series are zero.
        """
        times = self.start + (self.end - self.start) * fractions
        values = [self._at(name, times) for name in names]
        return np.array(values).reshape(len(values), *np.shape(fractions))

    def _at(self, name: str, times: Array) -> Array:
        if name == "initial.t":
            return np.full(times.shape, self.start)
        if name.startswith("initial."):
            return np.full(times.shape, self._at(name[8:], np.array(self.start)))
        curve = self.curve(name)
        return np.zeros(times.shape) if curve is None else np.asarray(curve(times))


def straight_lines(names: Sequence[str], times: Array, values: Array) -> Curves:
    """Straight lines through values (names, times)."""
    values = np.reshape(values, (len(names), len(times)))  # of no names, too
    ends = np.stack([values[:, :-1], values[:, 1:]], axis=1)
    return Curves.through(names, times, [-1.0, 1.0], np.moveaxis(ends, (0, 1, 2), (2, 1, 0)))
