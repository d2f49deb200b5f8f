"""The mesh of a phase: knots as fractions of its duration."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Mesh:
    """Knots from 0 to 1, increasing; segment k runs from ``knots[k]`` to ``knots[k + 1]``."""

    knots: Array

    @classmethod
    def uniform(cls, segments: int) -> Self:
        """Segments of equal length."""
        return cls(np.linspace(0.0, 1.0, segments + 1))

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.knots) - 1

    def fractions(self, nodes: Array) -> Array:
        """Where nodes in [0, 1] of every segment lie in the phase: (segments, nodes)."""
        return self.knots[:-1, None] + np.diff(self.knots)[:, None] * nodes[None, :]

    def subdivide(self, parts: NDArray[np.int_]) -> Self:
        """Each segment cut into ``parts[k]`` equal parts."""
        pieces = [
            np.linspace(a, b, count, endpoint=False)
            for a, b, count in zip(self.knots[:-1], self.knots[1:], parts, strict=True)
        ]
        return type(self)(np.concatenate([*pieces, [1.0]]))
