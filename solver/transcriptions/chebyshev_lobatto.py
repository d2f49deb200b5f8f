"""Chebyshev-Lobatto collocation, global where there is one segment (003, section 7.14)."""

import casadi as ca
import numpy as np

from footfall.curves import fit
from solver.expressions import SX
from solver.mesh.nodes import chebyshev_lobatto, differentiation_matrix, quadrature_weights
from solver.transcriptions.base import Array, Collocation, Node, Segment, Transcription


class ChebyshevLobatto(Transcription):
    """States and controls are polynomials of one degree, collocated at all their nodes.

    The defects at both ends of a segment leave the discrete optimum a little short of the true
    one; that, too, vanishes with the degree. For many segments ``radau`` is the better choice.

    Converges faster than any power of the degree where the solution is analytic; rings where a
    control jumps.

    Parameters
    ----------
    degree
        Of the polynomials on each segment; there are degree + 1 nodes.
    """

    order = None

    def __init__(self, degree: int) -> None:
        self.error_order = degree
        self.nodes = tuple(Node(fraction) for fraction in chebyshev_lobatto(degree))
        self.weights = tuple(quadrature_weights(self.fractions))
        self._derivative = differentiation_matrix(self.fractions)

    def collocate(self, segment: Segment) -> Collocation:
        """The polynomials' slopes are the derivatives at every node: D X = h F (7.75)."""
        points = segment.points
        x = ca.horzcat(*(point.x for point in points))
        f = ca.horzcat(*(segment.derivative(point) for point in points))
        slopes = ca.mtimes(x, ca.DM(self._derivative.T))
        return Collocation(points, ca.vec(SX(slopes - segment.h * f)), self.weighted(points))

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array]:
        """At the nodes inside of a segment, multipliers over weights."""
        count = len(self.nodes)
        rows = multipliers[:, : count * states].reshape(-1, count, states)
        inner = slice(1, count - 1)
        return self.fractions[inner], (-rows / np.array(self.weights)[:, None])[:, inner]

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """The polynomial through the nodes."""
        del f, h
        return fit(2 * self.fractions - 1, x)

    def control_curve(self, u: Array, h: Array) -> Array:
        """The polynomial through the nodes."""
        del h
        return fit(2 * self.fractions - 1, u)
