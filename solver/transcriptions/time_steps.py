"""Time steps of first order: a control and its forces are constant in each, as of its end.

Both kinds hold ``q1 = q0 + h v1``; the rates at a knot are the chord of the step that ends there.
"""

from typing import Literal

import casadi as ca
import numpy as np

from footfall.curves import fit
from solver.expressions import SX
from solver.transcriptions.base import (
    Array,
    Collocation,
    Indices,
    Node,
    Point,
    Segment,
    StepRow,
    Transcription,
)

Part = Literal["any", "first", "second"]


class TimeStep(Transcription):
    """A step whose balance of momentum the phase itself supplies (``PhaseFunctions.step``).

    Parameters
    ----------
    pairwise
        Whether steps come in pairs that share their time as they like (000, section 3.4).
    part
        Of which kind a step is, then: the second of a pair takes what the first leaves.
    """

    order = 1
    error_order = 2
    shares_controls = False
    stepped = True
    nodes = (Node(0.0, control=False, algebraic=False), Node(1.0))

    def __init__(self, *, pairwise: bool = False, part: Part = "any") -> None:
        self.pairwise, self.part = pairwise, part

    def strips(self, segments: int) -> list[tuple[Transcription, Indices]]:
        """The first and the second steps of the pairs, which have different rows."""
        places = np.arange(segments)
        if not self.pairwise:
            return [(self, places)]
        first, second = (type(self)(pairwise=True, part=part) for part in ("first", "second"))
        return [(first, places[::2]), (second, places[1::2])]

    def collocate(self, segment: Segment) -> Collocation:
        """Positions by the chord, momentum by the balance over the step."""
        start, end = segment.points
        start = Point(start.x, end.u, end.z, start.t)
        count = end.x.numel() // 2
        before, stretch = start.x[2 * count :], end.x[2 * count :]
        if not self.pairwise:
            before = stretch = SX(1)
        momentum, rows = segment.step(start, end, before, stretch)
        moved = end.x[:count] - start.x[:count] - segment.h * stretch * end.x[count : 2 * count]
        if self.part == "second":
            rows = (*rows, StepRow("pair of steps", before + stretch - 2))
        defects = ca.vertcat(moved, momentum)
        return Collocation((start, end), defects, ((stretch, end),), rows=rows)

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """Coordinates on straight lines, the rest constant."""
        del f, h
        count = x.shape[2] // 2
        rates = np.stack([x[:, 1, count:], x[:, 1, count:]], axis=1)
        return fit([-1.0, 1.0], np.concatenate([x[:, :, :count], rates], axis=2))

    def control_curve(self, u: Array, h: Array) -> Array:
        """Constant."""
        del h
        return fit([0.0], u[:, 1:])


class DiscreteGradient(TimeStep):
    """Steps by discrete gradients: contacts, limits and springs do exactly the work they should.

    See ``solver.discrete``, and the theory in docs/theory.md.
    """


class BackwardEuler(TimeStep):
    """The steps of 000, section 3.1: everything is evaluated at their ends."""
