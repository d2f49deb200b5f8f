"""The mesh of a phase: knots as fractions of its duration."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Mesh:
    """Knots from 0 to 1, increasing; segment k runs from ``knots[k]`` to ``knots[k + 1]``.

    ``degrees`` are the collocation points of each segment where the method has segments of
    different degree, else None.
    """

    knots: Array
    degrees: Counts | None = None

    @classmethod
    def uniform(cls, segments: int, points: int | None = None) -> Self:
        """Segments of equal length, each of ``points`` collocation points where that counts."""
        degrees = None if points is None else np.full(segments, points)
        return cls(np.linspace(0.0, 1.0, segments + 1), degrees)

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.knots) - 1

    def fractions(self, nodes: Array) -> Array:
        """Where nodes in [0, 1] of every segment lie in the phase: (segments, nodes)."""
        return self.knots[:-1, None] + np.diff(self.knots)[:, None] * nodes[None, :]

    def subdivide(self, parts: Counts) -> Self:
        """Each segment cut into ``parts[k]`` equal parts, all of its degree."""
        pieces = [
            np.linspace(a, b, count, endpoint=False)
            for a, b, count in zip(self.knots[:-1], self.knots[1:], parts, strict=True)
        ]
        degrees = None if self.degrees is None else np.repeat(self.degrees, parts)
        return type(self)(np.concatenate([*pieces, [1.0]]), degrees)

    def join(self, firsts: Sequence[int]) -> Self:
        """Segments joined to longer ones, of which each starts where ``firsts`` says.

        ``firsts`` begins with 0 and increases. A joined segment has the largest degree of those
        that went into it.
        """
        starts = np.asarray(firsts, dtype=int)
        degrees = None if self.degrees is None else np.maximum.reduceat(self.degrees, starts)
        return type(self)(np.concatenate([self.knots[starts], [1.0]]), degrees)
