"""What a transcription supplies: nodes, defects, quadrature weights, interpolant, order.

A new one is one file with a subclass, one line in ``TRANSCRIPTIONS`` and a variant in
``schemas/methods.py``. The order tests, the reference problems and the completeness test
enrol it from there.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

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
    """A segment completed: all its points, and the defects (in the states' units) to vanish."""

    points: tuple[Point, ...]
    defects: SX


class Transcription(ABC):
    """A way to turn a phase into equations on a mesh.

    Attributes
    ----------
    order
        The nominal order: on a smooth problem the error of the objective falls as h^order.
    nodes
        The nodes of a segment. The first and the last are its knots, which neighbours share;
        they carry states and controls, since constraints over the ends are stated there.
    weights
        The quadrature weights at the nodes, for a segment of length one.
    """

    order: ClassVar[int]
    nodes: tuple[Node, ...]
    weights: tuple[float, ...]

    @property
    def fractions(self) -> Array:
        """The nodes' places in [0, 1]."""
        return np.array([node.fraction for node in self.nodes])

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
        """

    @abstractmethod
    def control_curve(self, u: Array) -> Array:
        """Interpolate the controls, given as (segments, nodes, controls), in the same form."""
