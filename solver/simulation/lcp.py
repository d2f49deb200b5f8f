"""Linear complementarity problems by Lemke's method: find z >= 0 with w = M z + q >= 0, w'z = 0.

Source: Cottle, Pang and Stone, The Linear Complementarity Problem, sections 4.4 and 4.9.
"""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PIVOTS = (1e-9, 1e-11, 1e-7)
"""Entries of the scaled tableau below the first are round-off, and no pivot.

A pivot that was round-off shows in the solution; then the next is tried.
"""

TIE = 1e-11
"""Ratios closer than this are equal."""

ACCURACY = 1e-8
"""What w and z may violate, in the scaled problem."""


class LcpStatus(StrEnum):
    """How the pivoting ended."""

    SOLVED = "solved"
    RAY = "ray"
    """A secondary ray: Lemke's method finds no solution, and for many matrices there is none."""
    PIVOT_LIMIT = "pivot_limit"
    INACCURATE = "inaccurate"
    """The pivoting ended, but round-off spoiled what it ended with."""
    INVALID_NUMBER = "invalid_number"


class LcpSolution(NamedTuple):
    """``z`` (n,), or the last basic point where ``status`` is not solved."""

    z: Array
    status: LcpStatus
    pivots: int

    @property
    def solved(self) -> bool:
        """Whether ``z`` is a solution."""
        return self.status is LcpStatus.SOLVED


def solve_lcp(M: Array, q: Array, limit: int | None = None) -> LcpSolution:
    """Solve 0 <= z, 0 <= M z + q, z'(M z + q) = 0.

    The lexicographic rule decides between rows of equal ratios, so that degenerate problems do
    not cycle. Problems of contact with friction are copositive: for them a ray means that the
    linearised constraints contradict each other.

    Parameters
    ----------
    M
        Shape (n, n); neither symmetric nor definite.
    q
        Shape (n,).
    limit
        Of pivots; left out, 50 and 10 for each row.
    """
    if not (np.all(np.isfinite(M)) and np.all(np.isfinite(q))):
        return LcpSolution(np.full(len(q), np.nan), LcpStatus.INVALID_NUMBER, 0)
    if np.all(q >= 0):
        return LcpSolution(np.zeros(len(q)), LcpStatus.SOLVED, 0)
    scale = _scale(M)
    matrix, right = scale[:, None] * M * scale, scale * q
    size = float(np.max(np.abs(right)))
    right = right / size
    most = 50 + 10 * len(q) if limit is None else limit
    pivots = 0
    for smallest in PIVOTS:
        tableau = _Tableau(matrix, right, smallest)
        status, more = tableau.run(most)
        pivots += more
        z = _refined(matrix, right, tableau.z())
        if status is LcpStatus.SOLVED and not _solves(matrix, right, z):
            status = LcpStatus.INACCURATE
        if status is LcpStatus.SOLVED:
            break
    return LcpSolution(z * scale * size, status, pivots)


def _refined(M: Array, q: Array, z: Array) -> Array:
    """The same basis, solved for at once: pivots have gathered round-off."""
    basis = np.flatnonzero(z > 0)
    try:
        values = np.linalg.solve(M[np.ix_(basis, basis)], -q[basis])
    except np.linalg.LinAlgError:
        return z
    better = np.zeros_like(z)
    better[basis] = np.maximum(values, 0.0)
    return better if _violation(M, q, better) < _violation(M, q, z) else z


def _violation(M: Array, q: Array, z: Array) -> float:
    """The largest of ``min(z, w)`` in size."""
    return float(np.max(np.abs(np.minimum(z, M @ z + q))))


def _solves(M: Array, q: Array, z: Array) -> bool:
    return _violation(M, q, z) <= ACCURACY * (1.0 + float(np.max(z)))


def _scale(M: Array) -> Array:
    """D of D M D with ones on the diagonal: masses and lengths then weigh alike."""
    diagonal = np.diagonal(M)
    return np.where(diagonal > 0, 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 1.0)


class _Tableau:
    """Basic variables over the others: w is numbered 0 to n - 1, z from n, the artificial 2 n.

    Columns: the right-hand side, the inverse of the basis (of w), z, the artificial one. The
    first n + 1 are what the lexicographic rule compares.
    """

    def __init__(self, M: Array, q: Array, smallest: float) -> None:
        self.n, self.smallest = len(q), smallest
        n = self.n
        self.rows = np.hstack([q[:, None], np.eye(n), -M, -np.ones((n, 1))])
        self.basis = list(range(n))

    def run(self, limit: int) -> tuple[LcpStatus, int]:
        entering, row = 2 * self.n, self._worst()
        for pivots in range(1, limit + 1):
            leaving = self._pivot(row, entering)
            if leaving == 2 * self.n:
                return LcpStatus.SOLVED, pivots
            entering = (leaving + self.n) % (2 * self.n)
            found = self._leaving(entering)
            if found is None:
                return LcpStatus.RAY, pivots
            row = found
        return LcpStatus.PIVOT_LIMIT, limit

    def z(self) -> Array:
        values = np.zeros(2 * self.n + 1)
        values[self.basis] = self.rows[:, 0]
        return np.maximum(values[self.n : 2 * self.n], 0.0)

    def _worst(self) -> int:
        """The row that must leave so that the artificial variable makes all others feasible."""
        return _least(np.arange(self.n), self.rows[:, : self.n + 1])

    def _pivot(self, row: int, entering: int) -> int:
        column = self.rows[:, entering + 1].copy()
        self.rows[row] /= column[row]
        column[row] = 0.0
        self.rows -= column[:, None] * self.rows[row]
        leaving, self.basis[row] = self.basis[row], entering
        return leaving

    def _leaving(self, entering: int) -> int | None:
        column = self.rows[:, entering + 1]
        rows = np.flatnonzero(column > self.smallest)
        if not len(rows):
            return None
        ratios = self.rows[rows, : self.n + 1] / column[rows, None]
        artificial = [i for i, row in enumerate(rows) if self.basis[row] == 2 * self.n]
        if artificial and ratios[artificial[0], 0] <= np.min(ratios[:, 0]) + TIE:
            return int(rows[artificial[0]])  # an equal ratio: the solution is reached
        return _least(rows, ratios)


def _least(rows: NDArray[np.intp], keys: Array) -> int:
    """Of ``rows`` the one whose key is lexicographically least, equal within round-off."""
    left = np.arange(len(rows))
    for values in keys.T:
        chosen = values[left]
        left = left[chosen <= np.min(chosen) + TIE]
        if len(left) == 1:
            break
    return int(rows[left[0]])
