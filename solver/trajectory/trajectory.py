"""A phase's trajectory as piecewise polynomials: a guess, or what a solve ended with."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curves

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trajectory:
    """States and controls as curves over time in seconds, from ``start`` to ``end``."""

    start: float
    end: float
    states: Curves
    controls: Curves

    def sample_states(self, fractions: Array) -> Array:
        """The states at fractions of the duration, shape (states, *fractions.shape)."""
        return self._sample(self.states, fractions)

    def sample_controls(self, fractions: Array) -> Array:
        """The controls at fractions of the duration, shape (controls, *fractions.shape)."""
        return self._sample(self.controls, fractions)

    def _sample(self, curves: Curves, fractions: Array) -> Array:
        times = self.start + (self.end - self.start) * fractions
        values = [curve(times) for curve in curves.values()]
        return np.array(values).reshape(len(values), *np.shape(fractions))


def straight_lines(names: Sequence[str], times: Array, values: Array) -> Curves:
    """Straight lines through values (names, times)."""
    ends = np.stack([values[:, :-1], values[:, 1:]], axis=1)
    return Curves.through(names, times, [-1.0, 1.0], np.moveaxis(ends, (0, 1, 2), (2, 1, 0)))
