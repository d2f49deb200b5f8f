"""Hermite-Simpson collocation, separated and compressed (003, section 7.5)."""

from typing import Literal

import casadi as ca
import numpy as np

from footfall.curves import fit
from solver.mesh.polynomials import from_powers
from solver.transcriptions.base import Array, Collocation, Node, Point, Segment, Transcription


class HermiteSimpson(Transcription):
    """Derivative piecewise quadratic, state piecewise cubic; order 4.

    Parameters
    ----------
    form
        ``separated`` keeps the midpoint states as variables, ``compressed`` eliminates them.
    control
        ``quadratic`` through the midpoint, or ``linear`` between knots (no overshoot).
    """

    order = error_order = 4
    weights = (1 / 6, 4 / 6, 1 / 6)

    def __init__(
        self,
        form: Literal["separated", "compressed"] = "separated",
        control: Literal["quadratic", "linear"] = "quadratic",
    ) -> None:
        self.separated = form == "separated"
        self.quadratic = control == "quadratic"
        middle = Node(0.5, state=self.separated, control=self.quadratic)
        self.nodes = (Node(0.0), middle, Node(1.0))

    def collocate(self, segment: Segment) -> Collocation:
        """Hermite's midpoint (7.15) and Simpson's rule (7.16)."""
        a, middle, b = segment.points
        h, fa, fb = segment.h, segment.derivative(a), segment.derivative(b)
        hermite = (a.x + b.x) / 2 + h / 8 * (fa - fb)
        m = Point(
            middle.x if self.separated else hermite,
            middle.u if self.quadratic else (a.u + b.u) / 2,
            middle.z,
            middle.t,
        )
        simpson = b.x - a.x - h / 6 * (fa + 4 * segment.derivative(m) + fb)
        defects = [m.x - hermite, simpson] if self.separated else [simpson]
        hull = (2 * m.u - (a.u + b.u) / 2,) if self.quadratic else ()
        return Collocation((a, m, b), ca.vertcat(*defects), self.weighted((a, m, b)), hull)

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array]:
        """Simpson's defect spans its segment: its multiplier belongs to the middle."""
        first = states if self.separated else 0
        return np.array([0.5]), -multipliers[:, None, first : first + states]

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """Cubic from the state at the start and the three slopes (7.13.5)."""
        a, m, b = np.moveaxis(h[:, None] * f, 1, 0)
        powers = [x[:, 0], a, -(3 * a - 4 * m + b) / 2, 2 / 3 * (a - 2 * m + b)]
        return from_powers(np.stack(powers, axis=1))

    def control_curve(self, u: Array, h: Array) -> Array:
        """Quadratic through the midpoint (7.13.4), or linear between the knots."""
        del h
        if self.quadratic:
            return fit(2 * self.fractions - 1, u)
        return fit([-1.0, 1.0], u[:, [0, 2]])
