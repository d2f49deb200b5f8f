"""Trapezoidal collocation (003, section 7.4)."""

import numpy as np

from footfall.curves import fit
from solver.mesh.polynomials import from_powers
from solver.transcriptions.base import Array, Collocation, Node, Segment, Transcription


class Trapezoidal(Transcription):
    """Control and derivative piecewise linear, state piecewise quadratic; order 2."""

    order = error_order = 2
    nodes = (Node(0.0), Node(1.0))
    weights = (1 / 2, 1 / 2)

    def collocate(self, segment: Segment) -> Collocation:
        """The change of the state is the trapezoid rule over its derivative (7.9)."""
        a, b = segment.points
        mean = (segment.derivative(a) + segment.derivative(b)) / 2
        defects = b.x - a.x - segment.h * mean
        return Collocation(segment.points, defects, self.weighted(segment.points))

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array]:
        """A defect spans its segment: its multiplier belongs to the middle."""
        return np.array([0.5]), -multipliers[:, None, :states]

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """Quadratic from the state at the start and the two slopes (7.13.3)."""
        slopes = h[:, None] * f
        powers = [x[:, 0], slopes[:, 0], (slopes[:, 1] - slopes[:, 0]) / 2]
        return from_powers(np.stack(powers, axis=1))

    def control_curve(self, u: Array, h: Array) -> Array:
        """Linear between the knots (7.13.2)."""
        del h
        return fit(2 * self.fractions - 1, u)
