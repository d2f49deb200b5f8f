"""Names that are known by equations only, such as accelerations: Newton's method at every point."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.numeric.tape import Array, Tape

STEPS = 30
"""Of Newton's method; a point that takes more has no value."""

SETTLED = 1e-10
"""The last correction, relative to one plus the size of the unknowns."""

CLOSEST = 1e-6
"""The least distance of a column's difference, relative as before."""


@dataclass(frozen=True, slots=True)
class Solve:
    """As many residuals as unknowns; ``first`` is the slot of the first unknown among the inputs.

    The columns of the Jacobian are differences: over a distance of one at first, which is exact
    where the residuals are affine in the unknowns, as accelerations are in mechanics; then over
    the last correction. Each Jacobian serves two corrections, so affine residuals cost one.
    """

    residuals: Tape
    first: int

    def __call__(self, inputs: Sequence[Any], shape: tuple[int, ...]) -> Array:
        """The unknowns (names, *shape) at many points; NaN where there is no one solution.

        ``inputs`` has a place for every unknown; what stands there is not read.
        """
        count = len(self.residuals.outputs)
        unknowns, distance = np.zeros((count, *shape)), np.ones((count, *shape))
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                value, columns = self._slopes(inputs, unknowns, distance)
                unknowns = unknowns - _solved(columns, value)
                again = self._at(inputs, unknowns[:, None])[:, 0]
                correction = _solved(columns, again)
                unknowns = unknowns - correction
                size = 1 + np.abs(unknowns).max(axis=0)
                # NaN compares false: a point without a value does not get one by another step.
                unsettled = np.abs(correction).max(axis=0) > SETTLED * size
                if not unsettled.any():
                    return unknowns
                distance = np.maximum(np.abs(correction), CLOSEST * size)
        return np.where(unsettled, np.nan, unknowns)

    def _slopes(
        self, inputs: Sequence[Any], unknowns: Array, distance: Array
    ) -> tuple[Array, Array]:
        """Residuals (rows, *shape) and their columns (rows, names, *shape)."""
        count = len(unknowns)
        places = np.repeat(unknowns[:, None], count + 1, axis=1)
        diagonal = np.arange(count)
        places[diagonal, diagonal + 1] += distance
        moved = places[diagonal, diagonal + 1] - unknowns  # as rounded
        values = self._at(inputs, places)
        return values[:, 0], (values[:, 1:] - values[:, :1]) / moved

    def _at(self, inputs: Sequence[Any], unknowns: Array) -> Array:
        """Residuals (rows, places, *shape) at several places (names, places, *shape)."""
        filled = list(inputs)
        filled[self.first : self.first + len(unknowns)] = unknowns
        return self.residuals(filled, unknowns.shape[1:])


def _solved(columns: Array, right: Array) -> Array:
    """``columns @ x = right`` at every point, (names, *shape); NaN where that is singular."""
    A = np.moveaxis(columns, (0, 1), (-2, -1))
    b = np.moveaxis(right, 0, -1)[..., None]
    try:
        x = np.linalg.solve(A, b)
    except np.linalg.LinAlgError:
        singular = np.linalg.det(A) == 0
        x = np.linalg.solve(np.where(singular[..., None, None], np.nan, A), b)
    return np.asarray(np.moveaxis(x[..., 0], -1, 0))
