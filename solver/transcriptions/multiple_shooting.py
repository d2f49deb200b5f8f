"""Direct multiple shooting with explicit Runge-Kutta steps of order 4 (003, section 7.3.9)."""

import numpy as np

from footfall.curves import fit
from solver.expressions import SX
from solver.mesh.polynomials import from_powers
from solver.transcriptions.base import Array, Collocation, Node, Point, Segment, Transcription


class MultipleShooting(Transcription):
    """States are variables at the knots only; between them the motion is simulated.

    Each segment takes some classical Runge-Kutta steps under a control that is quadratic on each
    step, and must arrive at the next knot. Integrals are carried along by the same steps.

    Parameters
    ----------
    steps
        Runge-Kutta steps of each segment.
    """

    order = error_order = 4
    eliminates = True

    def __init__(self, steps: int) -> None:
        self.pieces = steps
        fractions = np.linspace(0.0, 1.0, 2 * steps + 1)
        self.nodes = tuple(Node(at, state=at in (0.0, 1.0)) for at in fractions.tolist())

    def collocate(self, segment: Segment) -> Collocation:
        """Simulate from the start; the gap at the end is the defect."""
        nodes, h = segment.points, segment.h / self.pieces
        points, quadrature, at = [nodes[0]], [], nodes[0]
        for middle, end in zip(nodes[1::2], nodes[2::2], strict=True):
            stages, reached = _step(segment, h, at, middle, end)
            quadrature += [
                (weight / (6 * self.pieces), stage)
                for weight, stage in zip((1, 2, 2, 1), stages, strict=True)
            ]
            arrival = Point(reached, end.u, end.z, end.t)
            slopes = segment.derivative(at) - segment.derivative(arrival)
            halfway = (at.x + reached) / 2 + h / 8 * slopes
            points += [Point(halfway, middle.u, middle.z, middle.t), arrival]
            at = arrival
        points[-1] = nodes[-1]
        hull = tuple(
            2 * middle.u - (start.u + end.u) / 2
            for start, middle, end in zip(nodes[:-1:2], nodes[1::2], nodes[2::2], strict=True)
        )
        return Collocation(tuple(points), nodes[-1].x - at.x, tuple(quadrature), hull)

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array]:
        """The gap lies at the segment's end."""
        return np.array([1.0]), -multipliers[:, None, :states]

    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """Cubic on each step, from the states and slopes at its ends."""
        a, b, fa, fb = (
            side.reshape(-1, x.shape[2])
            for side in (x[:, :-1:2], x[:, 2::2], f[:, :-1:2], f[:, 2::2])
        )
        length = np.repeat(h / self.pieces, self.pieces, axis=0)
        rise, fa, fb = b - a, length * fa, length * fb
        powers = [a, fa, 3 * rise - 2 * fa - fb, fa + fb - 2 * rise]
        return from_powers(np.stack(powers, axis=1))

    def control_curve(self, u: Array, h: Array) -> Array:
        """Quadratic on each step."""
        del h
        parts = np.stack([u[:, :-1:2], u[:, 1::2], u[:, 2::2]], axis=2)
        return fit([-1.0, 0.0, 1.0], parts.reshape(len(u) * self.pieces, 3, u.shape[2]))


def _step(
    segment: Segment, h: SX, start: Point, middle: Point, end: Point
) -> tuple[list[Point], SX]:
    """One classical Runge-Kutta step: its four stages, and the state that it reaches."""
    stages = [start]
    for share, node in ((0.5, middle), (0.5, middle), (1.0, end)):
        ahead = start.x + share * h * segment.derivative(stages[-1])
        stages.append(Point(ahead, node.u, node.z, node.t))
    k1, k2, k3, k4 = (segment.derivative(stage) for stage in stages)
    return stages, start.x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
