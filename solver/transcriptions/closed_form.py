"""A motion known in closed form: no collocation, the formula itself (004's ballistic flight)."""

from dataclasses import replace

import casadi as ca
import numpy as np

from footfall.curves import fit
from solver.mesh.nodes import chebyshev_lobatto, quadrature_weights
from solver.transcriptions.base import Array, Collocation, Node, Segment, Transcription

DEGREE = 12
"""Of the published polynomials: exact for ballistic flight, round-off for most else."""


class ClosedForm(Transcription):
    """States at both ends are variables; the last must be where the formula arrives.

    Between them the formula is evaluated from the state and time at the start, at Chebyshev
    points, through which the published curve goes.
    """

    order = None
    error_order = DEGREE
    rigid = True

    def __init__(self) -> None:
        fractions = chebyshev_lobatto(DEGREE)
        self.nodes = tuple(
            Node(fraction, state=fraction in (0.0, 1.0), control=False) for fraction in fractions
        )
        self.weights = tuple(quadrature_weights(self.fractions))

    def collocate(self, segment: Segment) -> Collocation:
        """The arrival's gap is the defect."""
        first, last = segment.points[0], segment.points[-1]
        natives = ca.vertcat(first.x, first.t)
        points = tuple(
            replace(
                point,
                x=point.x if node.state else segment.flow(natives, point.t),
                natives=natives,
            )
            for node, point in zip(self.nodes, segment.points, strict=True)
        )
        defects = last.x - segment.flow(natives, last.t)
        return Collocation(points, defects, self.weighted(points))

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """The polynomial through the nodes."""
        del f, h
        return fit(2 * self.fractions - 1, x)

    def control_curve(self, u: Array, h: Array) -> Array:
        """There are none."""
        del h
        return np.zeros((u.shape[2], u.shape[0], 1))
