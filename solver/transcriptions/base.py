"""What a transcription supplies: nodes, defects, quadrature weights, interpolant, order.

A new one is one file with a subclass, one line in ``TRANSCRIPTIONS`` and a variant in
``schemas/methods.py``. The order tests, the reference problems and the completeness test
enrol it from there.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.expressions import SX

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Node:
    """A node of a segment at ``fraction`` in [0, 1]; whether it carries decision variables."""

    fraction: float
    state: bool = True
    control: bool = True


@dataclass(frozen=True, slots=True)
class Point:
    """State (n_x,), control (n_u,) and time (scalar) at a node; SI units."""

    x: SX
    u: SX
    t: SX


@dataclass(frozen=True, slots=True)
class Segment:
    """A segment as symbols. Where a node carries no variable, ``x`` or ``u`` is empty."""

    points: tuple[Point, ...]
    h: SX
    derivative: Callable[[Point], SX]


@dataclass(frozen=True, slots=True)
class Collocation:
    """A segment completed.

    Attributes
    ----------
    points
        The points at all nodes.
    defects
        What shall vanish, in the states' units; a whole number of times the states.
    quadrature
        Weights and points whose weighted sum, times h, integrates along the segment.
    """

    points: tuple[Point, ...]
    defects: SX
    quadrature: tuple[tuple[float, Point], ...]


class Transcription(ABC):
    """A way to turn a phase into equations on a mesh.

    Attributes
    ----------
    order
        The nominal order: on a smooth problem the error of the objective falls as h^order.
        None where a method converges by its degree instead.
    error_order
        The mesh error of a segment falls as h^error_order; refinement counts on it.
    nodes
        The nodes of a segment. The first and the last are its knots, which carry states that
        neighbours share. The last one carries controls, too.
    shares_controls
        Whether neighbours share the controls of their common knot; else a control may jump
        there, and the first node carries none.
    weights
        The quadrature weights at the nodes, for a segment of length one; for ``weighted``.
    pieces
        Polynomials of a curve on each segment.
    """

    order: int | None
    error_order: int
    shares_controls: bool = True
    nodes: tuple[Node, ...]
    weights: tuple[float, ...] = ()
    pieces: int = 1

    @property
    def fractions(self) -> Array:
        """The nodes' places in [0, 1]."""
        return np.array([node.fraction for node in self.nodes])

    def weighted(self, points: tuple[Point, ...]) -> tuple[tuple[float, Point], ...]:
        """The quadrature of ``weights`` over the nodes."""
        return tuple(zip(self.weights, points, strict=True))

    @abstractmethod
    def collocate(self, segment: Segment) -> Collocation:
        """Complete the points and state the defects."""

    @abstractmethod
    def state_curve(self, x: Array, f: Array, h: Array) -> Array:
        """Interpolate the states: Chebyshev coefficients (states, segments, degree + 1).

        Parameters
        ----------
        x, f
            States and their derivatives at the nodes, shape (segments, nodes, states).
        h
            Lengths of the segments in seconds, shape (segments, 1).

        Where there are several ``pieces``, they count as segments of the result.
        """

    @abstractmethod
    def control_curve(self, u: Array) -> Array:
        """Interpolate the controls, given as (segments, nodes, controls), in the same form."""
