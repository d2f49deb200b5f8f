"""Pairs of which a member is zero by what is fixed: an end that asks for contact pins its gap.

There ``a b = eps`` cannot hold, and the pair takes ``a b <= eps`` instead.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.complementarity.pairs import Pairing
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Mask = NDArray[np.bool_]

_ZERO = 1e-9  # of a member, over its size; and of a row
_NUDGE = 0.1  # of each variable's size: how far the test points lie from the start
_SWEEPS = 10  # what is fixed may fix more: rest fixes the pose a step before, a pose its gaps


def pinned_pairs(task: NlpTask, pairing: Pairing) -> Mask:
    """Which pairs (k,) have a member that fixed variables and equalities alone make zero.

    A variable is known where the program fixes it, or where an equality that is linear in it
    depends on no other unknown, whatever the unknowns are.
    """
    known = np.isfinite(pairing.fixed)
    z = np.where(known, pairing.fixed, task.start)
    equalities = _Equalities.of(task, pairing)
    for _ in range(_SWEEPS):
        found, values = equalities.decided(z, known)
        if len(found) == 0:
            break
        known[found], z[found] = True, values
    zero = np.abs(pairing.values(z)) <= _ZERO
    return np.asarray((known[pairing.members] & zero).any(axis=1))


@dataclass(frozen=True, slots=True)
class _Equalities:
    """The equalities but for the pairs' own: the entries of their Jacobian, and test steps."""

    task: NlpTask
    rows: Indices
    columns: Indices
    kept: Mask
    steps: tuple[Array, Array]

    @classmethod
    def of(cls, task: NlpTask, pairing: Pairing) -> "_Equalities":
        equal = task.row_lower == task.row_upper
        equal[pairing.rows] = False
        sides = task.nlp.jacobian.sparsity_out(1).get_triplet()
        rows, columns = (np.array(side, dtype=int) for side in sides)
        kept, rng = equal[rows], np.random.default_rng(0)
        one, other = _NUDGE * rng.standard_normal((2, len(task.start)))
        return cls(task, rows[kept], columns[kept], kept, (one, other))

    def decided(self, z: Array, known: Mask) -> tuple[Indices, Array]:
        """Variables that one more row each decides, and their values, whatever the rest is."""
        points = [np.where(known, z, z + step) for step in self.steps]
        slopes = [self._slopes(point) for point in points]
        live = ~known[self.columns] & np.any([slope != 0 for slope in slopes], axis=0)
        alone = np.bincount(self.rows[live], minlength=len(self.task.row_lower)) == 1
        last = np.flatnonzero(live & alone[self.rows])
        columns, first = np.unique(self.columns[last], return_index=True)
        if len(columns) == 0:
            return columns, np.empty(0)
        rows = self.rows[last[first]]
        with np.errstate(divide="ignore", invalid="ignore"):
            values, others = (
                point[columns] - self._off(point, rows) / slope[last[first]]
                for point, slope in zip(points, slopes, strict=True)
            )
        same = np.abs(values - others) <= _ZERO * (1 + np.abs(values))
        return columns[same], values[same]

    def _slopes(self, z: Array) -> Array:
        return np.array(self.task.nlp.jacobian(z, [])[1].nonzeros())[self.kept]

    def _off(self, z: Array, rows: Indices) -> Array:
        off: Array = self.task.nlp.evaluate(z)[1].full().ravel()[rows] - self.task.row_lower[rows]
        return off
