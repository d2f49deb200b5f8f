"""Names that are known by equations only, such as accelerations: Newton's method at every point."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.numeric.tape import Array, Tape

STEPS = 60
"""Of Newton's method; a point that takes more has no value."""

SETTLED = 1e-10
"""The last correction, relative to one plus the size of the unknowns."""

CLOSEST = 1e-6
"""The distance of a column's difference where the residuals are not affine, relative as before."""

ILL = 1e12
"""The condition of equations, each of unit size, that have no one solution."""

LARGE = 1e6
"""Unknowns above it make one ask whether the equations have one solution at all."""

SHARES = 0.5 ** np.arange(8)
"""Of a step, of which the one is taken that leaves the smallest residual."""


@dataclass(frozen=True, slots=True)
class Solve:
    """As many residuals as unknowns; ``first`` is the slot of the first unknown among the inputs.

    The columns of the Jacobian are differences. The first one is over a distance of one, which is
    exact where the residuals are affine in the unknowns, as accelerations are in mechanics: such
    points are done after it. The others go on with short differences, and with steps as long as
    they bring the residuals down.
    """

    residuals: Tape
    first: int

    def __call__(self, inputs: Sequence[Any], shape: tuple[int, ...]) -> Array:
        """The unknowns (names, *shape) at many points; NaN where there is no one solution.

        ``inputs`` has a place for every unknown; what stands there is not read.
        """
        count = len(self.residuals.outputs)
        unknowns = np.zeros((count, *shape))
        with np.errstate(all="ignore"):
            value, columns = self._slopes(inputs, unknowns, np.ones((count, *shape)))
            unknowns = unknowns - _solved(columns, value)
            if np.any(np.abs(unknowns) > LARGE):
                unknowns = np.where(_dependent(columns), np.nan, unknowns)
            step = _solved(columns, self._at(inputs, unknowns[:, None])[:, 0])
            unknowns = unknowns - step
            unsettled = _unsettled(unknowns, step)
            for _ in range(STEPS):
                if not unsettled.any():
                    return unknowns
                unknowns, step = self._damped(inputs, unknowns)
                unsettled = _unsettled(unknowns, step)
        return np.where(unsettled, np.nan, unknowns)

    def _damped(self, inputs: Sequence[Any], unknowns: Array) -> tuple[Array, Array]:
        """The unknowns after one step of Newton's method, and the whole step."""
        size = 1 + np.abs(unknowns).max(axis=0)
        value, columns = self._slopes(
            inputs, unknowns, np.broadcast_to(CLOSEST * size, unknowns.shape)
        )
        step = np.where(_dependent(columns), np.nan, _solved(columns, value))
        shares = SHARES.reshape(-1, *[1] * (unknowns.ndim - 1))
        places = unknowns[:, None] - shares * step[:, None]
        left = np.abs(self._at(inputs, places)).max(axis=0)
        best = np.argmin(np.where(np.isnan(left), np.inf, left), axis=0)
        return unknowns - SHARES[best] * step, step

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


def _dependent(columns: Array) -> NDArray[np.bool_]:
    """Where the equations depend on each other but for rounding, (*shape)."""
    rows = columns / np.abs(columns).max(axis=1, keepdims=True)
    finite = np.where(np.isfinite(rows), rows, 0.0)
    return np.asarray(np.linalg.cond(np.moveaxis(finite, (0, 1), (-2, -1))) > ILL)


def _unsettled(unknowns: Array, step: Array) -> NDArray[np.bool_]:
    """Where the last step was too long to stop, (*shape).

    NaN compares false: a point without a value does not get one by another step.
    """
    size = 1 + np.abs(unknowns).max(axis=0)
    return np.asarray(np.abs(step).max(axis=0) > SETTLED * size)
