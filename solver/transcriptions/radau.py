"""Flipped Legendre-Gauss-Radau collocation on many segments (003, 7.14; Garg et al., 2010)."""

import casadi as ca
import numpy as np

from footfall.curves import fit
from solver.expressions import SX
from solver.mesh.nodes import (
    differentiation_matrix,
    interpolation_row,
    legendre_radau,
    quadrature_weights,
)
from solver.transcriptions.base import Array, Collocation, Node, Point, Segment, Transcription


class Radau(Transcription):
    """States are polynomials of degree n on each segment, controls of degree n - 1.

    The dynamics hold at the n Radau points, of which the segment's end is one. A control may
    jump at every knot; at a segment's start it is the polynomial's value there.

    Parameters
    ----------
    points
        Collocation points n of each segment; the order is 2 n - 1.
    """

    def __init__(self, points: int) -> None:
        inner = legendre_radau(points)
        self.order = 2 * points - 1
        self.error_order = points + 1
        self.shares_controls = False
        self.nodes = (Node(0.0, control=False), *(Node(fraction) for fraction in inner))
        self._places = np.array(inner)
        self.weights = (0.0, *quadrature_weights(self._places))
        self._derivative = differentiation_matrix(self.fractions)[1:]
        self._start = interpolation_row(self._places, 0.0)

    def collocate(self, segment: Segment) -> Collocation:
        """The state's slope is the derivative at the Radau points: D X = h F."""
        first, *inner = segment.points
        u = ca.horzcat(*(point.u for point in inner))
        points = (Point(first.x, ca.mtimes(u, ca.DM(self._start)), first.t), *inner)
        x = ca.horzcat(first.x, *(point.x for point in inner))
        f = ca.horzcat(*(segment.derivative(point) for point in inner))
        slopes = ca.mtimes(x, ca.DM(self._derivative.T))
        return Collocation(points, ca.vec(SX(slopes - segment.h * f)), self.weighted(points))

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """The polynomial through the start and the Radau points."""
        del f, h
        return fit(2 * self.fractions - 1, x)

    def control_curve(self, u: Array) -> Array:
        """The polynomial through the Radau points."""
        return fit(2 * self._places - 1, u[:, 1:])
