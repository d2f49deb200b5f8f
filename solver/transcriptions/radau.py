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
from solver.mesh.polynomials import corners
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
        self.nodes = (
            Node(0.0, control=False, algebraic=False),
            *(Node(fraction) for fraction in inner),
        )
        self._places = np.array(inner)
        self.weights = (0.0, *quadrature_weights(self._places))
        self._derivative = differentiation_matrix(self.fractions)[1:]
        self._start = interpolation_row(self._places, 0.0)
        self._corners = corners(self._places)[:-1]

    @property
    def degree(self) -> int:
        """The collocation points."""
        return len(self._places)

    def at_degree(self, points: int) -> "Radau":
        """The same with another number of collocation points."""
        return Radau(points)

    def collocate(self, segment: Segment) -> Collocation:
        """The state's slope is the derivative at the Radau points: D X = h F."""
        first, *inner = segment.points
        controls, unknowns = (
            ca.horzcat(*(getattr(point, name) for point in inner)) for name in ("u", "z")
        )
        u, z = (ca.mtimes(values, ca.DM(self._start)) for values in (controls, unknowns))
        points = (Point(first.x, u, z, first.t), *inner)
        hull = ca.horzsplit(ca.mtimes(controls, ca.DM(self._corners.T)))
        x = ca.horzcat(first.x, *(point.x for point in inner))
        f = ca.horzcat(*(segment.derivative(point) for point in inner))
        slopes = ca.mtimes(x, ca.DM(self._derivative.T))
        defects = ca.vec(SX(slopes - segment.h * f))
        return Collocation(points, defects, self.weighted(points), tuple(hull))

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array]:
        """At the Radau points, multipliers over weights (Garg et al., 2010, equation 57)."""
        count = len(self._places)
        rows = multipliers[:, : count * states].reshape(-1, count, states)
        return self._places, -rows / np.array(self.weights[1:])[:, None]

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """The polynomial through the start and the Radau points."""
        del f, h
        return fit(2 * self.fractions - 1, x)

    def control_curve(self, u: Array, h: Array) -> Array:
        """The polynomial through the Radau points."""
        del h
        return fit(2 * self._places - 1, u[:, 1:])
