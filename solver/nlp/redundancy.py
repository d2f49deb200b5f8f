"""Equality constraints that others imply: found by the rank of the Jacobian, dropped, reported.

A redundant row leaves the multipliers undetermined and breaks most solvers. The equality rows,
and as rows of their own the values fixed at the end of each phase, are factorised in order; a
row whose pivot vanishes is suspected to lie in the span of those before it. It counts as implied
if it does so at two random points near the guess, values included: then it is dropped. Rows that
contradict the others are kept, for the solver to refuse and for the report to name. Inequalities
whose value the equalities decide are dropped, too (``decided.py``), without a word: they hold.
"""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from solver.nlp.assembly import Nlp
from solver.nlp.decided import decided_rows
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Matrix = Any  # a scipy.sparse.csr_array; scipy ships no types

_PIVOT = 1e-9  # squared distance of a unit row to the span of the rows before it
_MATCH = 1e-7  # relative residual up to which a row equals a combination of others
_NUDGE = 1e-2  # of each variable's size: how far the test points lie from the guess
_TRIFLE = 1e-14  # keeps a factorisation of dependent rows from dividing by zero
_AT_ONCE = 64  # suspects: bounds the memory where there is one at every node


@dataclass(frozen=True, slots=True)
class Redundancy:
    """What is implied: positions of rows and of fixed variables, and how to call them.

    ``decided`` are positions of inequalities; ``names`` has each name of an equality once, at
    however many nodes it stands; ``conflicts`` names equalities that depend on others but ask for
    another value.
    """

    rows: Indices
    fixed: Indices
    decided: Indices
    names: tuple[str, ...]
    conflicts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Equalities:
    """The equalities under test: rows of the program, then variables fixed at the end."""

    program: Program
    scaling: Scaling
    rows: Indices
    fixed: Indices
    pinned: Indices

    @classmethod
    def of(cls, program: Program, scaling: Scaling) -> Self:
        lower, upper = program.row_vector("lower", 0.0), program.row_vector("upper", 0.0)
        variables = program.variables
        held = variables.gather("lower") == variables.gather("upper")
        last = np.zeros(variables.size, dtype=bool)
        for block in variables.blocks:
            last[block.indices[:, block.fractions == 1.0]] = True
        pinned, fixed = np.flatnonzero(held & ~last), np.flatnonzero(held & last)
        return cls(program, scaling, np.flatnonzero(lower == upper), fixed, pinned)

    def at(self, nlp: Nlp, nudge: Array) -> tuple[Matrix, Array]:
        """Their Jacobian, each row of unit length, and their values, near the guess."""
        variables, scale = self.program.variables, self.scaling.columns
        lower = variables.gather("lower") / scale
        z = variables.gather("guess") / scale + nudge
        z[self.pinned] = lower[self.pinned]
        rows, jacobian = nlp.jacobian(z, [])
        targets = self.program.row_vector("lower", 0.0) / self.scaling.rows
        values = [(rows.full().ravel() - targets)[self.rows], (z - lower)[self.fixed]]
        unit = sparse.eye_array(len(z), format="csr")[self.fixed]
        whole = sparse.vstack([sparse.csr_array(jacobian.sparse())[self.rows], unit]).tocsc()
        free = np.setdiff1d(np.arange(len(z)), self.pinned)
        matrix = sparse.csr_array(whole[:, free])
        squares = np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel()
        length = np.where(squares > 0, np.sqrt(squares), 1.0)
        return sparse.csr_array(sparse.diags_array(1 / length) @ matrix), np.concatenate(
            values
        ) / length

    def shared(self) -> NDArray[np.bool_]:
        """Columns of the Jacobian that many rows may use: variables at no node, such as times."""
        anywhere = np.zeros(self.program.variables.size, dtype=bool)
        for block in self.program.variables.blocks:
            anywhere[block.indices[:, np.isnan(block.fractions)]] = True
        return np.delete(anywhere, self.pinned)

    def names(self, positions: Indices) -> tuple[str, ...]:
        """How a report calls some equalities, each name once."""
        labels = [label.name for label in self.program.labels()]
        final = {
            int(index): f"final {name}"
            for block in self.program.variables.blocks
            for name, indices in zip(block.names, block.indices, strict=True)
            for index in indices
        }
        called = [labels[row] for row in self.rows] + [final[index] for index in self.fixed]
        return tuple(dict.fromkeys(called[position] for position in positions))


def find_redundancy(program: Program, scaling: Scaling, nlp: Nlp) -> Redundancy:
    """Equalities of the program that follow from the others, inequalities that they decide."""
    equalities = _Equalities.of(program, scaling)
    rng = np.random.default_rng(0)
    nudges = _NUDGE * rng.standard_normal((2, program.variables.size))
    first = equalities.at(nlp, nudges[0])
    suspects = _dependent_rows(*first, equalities.shared())
    # Most programs have none: then the second point is not worth its evaluation.
    tests = [first, equalities.at(nlp, nudges[1])] if len(suspects) else [first]
    found = [_deviations(matrix, values, suspects) for matrix, values in tests]
    spanned = np.all([distances < _MATCH for distances, _ in found], axis=0)
    agree = np.all([gaps < _MATCH for _, gaps in found], axis=0)
    implied, split = suspects[spanned & agree], len(equalities.rows)
    return Redundancy(
        equalities.rows[implied[implied < split]],
        equalities.fixed[implied[implied >= split] - split],
        decided_rows(program, scaling, nlp),
        equalities.names(implied),
        equalities.names(suspects[spanned & ~agree]),
    )


def _dependent_rows(matrix: Matrix, values: Array, shared: NDArray[np.bool_]) -> Indices:
    """Rows in the span of the others, of a dependent set the last ones.

    A column that all rows use would fill A A', at the price of its rank cubed; so the pivots are
    taken without the shared ones. That suspects too many, at most one for each such column.
    """
    if not np.all(np.isfinite(matrix.data)):
        return np.array([], dtype=int)
    suspects = _vanishing_pivots(matrix[:, np.flatnonzero(~shared)])
    for _ in range(int(shared.sum())):
        outside = np.flatnonzero(_deviations(matrix, values, suspects)[0] >= _MATCH)
        if len(outside) == 0:
            break
        suspects = np.delete(suspects, outside[0])
    return suspects


def _factors(matrix: Matrix, **options: Any) -> Any:
    """A sparse LU; SuperLU reports missing memory as a RuntimeError of its own."""
    try:
        return splu(matrix, **options)
    except RuntimeError as error:
        if "MALLOC" in str(error):
            raise MemoryError("the search for implied equalities ran out of memory") from error
        raise


def _vanishing_pivots(matrix: Matrix) -> Indices:
    """Rows in the span of those before them, by the pivots of A A' in order."""
    if matrix.shape[0] == 0:
        return np.array([], dtype=int)
    gram = sparse.csc_array(matrix @ matrix.T + _TRIFLE * sparse.eye_array(matrix.shape[0]))
    options = {"SymmetricMode": True}
    factors = _factors(gram, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
    return np.flatnonzero(np.abs(factors.U.diagonal()) < _PIVOT)


def _deviations(matrix: Matrix, values: Array, rows: Indices) -> tuple[Array, Array]:
    """How far rows (k,), and their values, are from the nearest combinations of all others.

    Least squares by the augmented system [I B'; B 0], which full columns of B do not fill.
    """
    if len(rows) == 0:
        return np.empty(0), np.empty(0)
    if not np.all(np.isfinite(matrix.data)):
        return np.full(len(rows), np.inf), np.full(len(rows), np.inf)
    others = np.setdiff1d(np.arange(matrix.shape[0]), rows)
    basis, width = matrix[others], matrix.shape[1]
    corner = -_TRIFLE * sparse.eye_array(len(others))
    factors = _factors(
        sparse.block_array([[sparse.eye_array(width), basis.T], [basis, corner]]).tocsc()
    )
    distances, gaps = [], []
    for some in np.array_split(rows, -(-len(rows) // _AT_ONCE)):
        targets = matrix[some].toarray().T
        padded = np.concatenate([targets, np.zeros((len(others), len(some)))])
        combinations = factors.solve(padded)[width:]
        distances.append(np.linalg.norm(targets - basis.T @ combinations, axis=0))
        gaps.append(np.abs(values[others] @ combinations - values[some]))
    return np.concatenate(distances), np.concatenate(gaps)
