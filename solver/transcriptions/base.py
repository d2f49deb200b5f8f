"""What a transcription supplies: nodes, defects, quadrature weights, interpolant, order.

A new one is one file with a subclass, one line in ``TRANSCRIPTIONS`` and a variant in
``schemas/methods.py``. The order tests, the reference problems and the completeness test
enrol it from there.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.expressions import SX

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Node:
    """A node of a segment at ``fraction`` in [0, 1]; whether it carries decision variables.

    ``algebraic`` variables stand wherever the dynamics or the integrands are evaluated. ``native``
    names the orders of the derivatives that are variables here, of a method that differentiates
    its own curves; they belong to the segment alone.
    """

    fraction: float
    state: bool = True
    control: bool = True
    algebraic: bool = True
    native: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Point:
    """State (n_x,), control (n_u,), algebraic values (n_z,) and time at a node; SI units.

    ``natives`` (n_n,) are what the method itself supplies there.
    """

    x: SX
    u: SX
    z: SX
    t: SX
    natives: SX = field(default_factory=lambda: SX(0, 1))


class StepRow(NamedTuple):
    """A row of a whole step: its label, its value, its limits."""

    label: str
    value: SX
    lower: float = 0.0
    upper: float = 0.0


def _no_step(*_: object) -> tuple[SX, tuple[StepRow, ...]]:
    raise TypeError("this phase has no balance of steps")


@dataclass(frozen=True, slots=True)
class Segment:
    """A segment as symbols. Of its points, what carries no variable is empty.

    ``derivative`` gives the rates of the states at a point; ``flow`` the states of a closed form
    at a time, from its natives; ``step`` the balance of momentum between two points, and rows of
    its own (``solver.discrete``), given the lengths of the step before and of this one
    over those of the mesh.
    """

    points: tuple[Point, ...]
    h: SX
    derivative: Callable[[Point], SX]
    flow: Callable[[SX, SX], SX]
    step: Callable[[Point, Point, SX, SX], tuple[SX, tuple[StepRow, ...]]] = _no_step


@dataclass(frozen=True, slots=True)
class Collocation:
    """A segment completed.

    Attributes
    ----------
    points
        The points at all nodes.
    defects
        What shall vanish, in the states' units; a whole number of times the states, or nothing
        where the path constraints say it all.
    quadrature
        Weights and points whose weighted sum, times h, integrates along the segment.
    hull
        Controls (n_u,) whose bounds, with those at the knots, keep the whole curve within them;
        of methods whose controls would pass their bounds between the nodes.
    rows
        Further rows.
    """

    points: tuple[Point, ...]
    defects: SX
    quadrature: tuple[tuple[float | SX, Point], ...]
    hull: tuple[SX, ...] = ()
    rows: tuple[StepRow, ...] = ()


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
    native
        Whether the method differentiates its own curves; it then takes the native form of
        second-order systems (``solver.lowering.lower_native``).
    eliminates
        Whether unknown accelerations must be eliminated, since the dynamics are evaluated
        between the nodes, where there are no variables for them.
    rigid
        Whether the mesh is not to be refined.
    stepped
        Whether segments are time steps through contact: forces belong to a whole step, and the
        mesh is judged by what the steps dissipate.
    """

    order: int | None
    error_order: int
    shares_controls: bool = True
    nodes: tuple[Node, ...]
    weights: tuple[float, ...] = ()
    pieces: int = 1
    native: bool = False
    eliminates: bool = False
    rigid: bool = False
    stepped: bool = False

    def strips(self, segments: int) -> list[tuple["Transcription", Indices]]:
        """Segments of one kind each: which they are, where the method has several kinds."""
        return [(self, np.arange(segments))]

    def at_degree(self, points: int) -> "Transcription":
        """The same method with so many collocation points a segment, where that can be chosen."""
        del points
        return self

    @property
    def degree(self) -> int | None:
        """Collocation points a segment, where each segment may have its own; else None."""
        return None

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
    def control_curve(self, u: Array, h: Array) -> Array:
        """Interpolate the controls, given as (segments, nodes, controls), in the same way."""

    def costates(self, multipliers: Array, states: int) -> tuple[Array, Array] | None:
        """The costates that the defects' multipliers stand for, where the method knows them.

        Parameters
        ----------
        multipliers
            Of the rows of each segment, the defects first, (segments, rows).
        states
            The number of states.

        Returns
        -------
        Places in [0, 1] of a segment (k,), and the costates there (segments, k, states).
        """
        del multipliers, states
        return None
