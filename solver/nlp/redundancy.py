"""Equality constraints that others imply: found by the rank of the Jacobian, dropped, reported.

A redundant row leaves the multipliers undetermined and breaks most solvers. The equality rows,
and as rows of their own the values fixed at the end of each phase, are factorised in order; a
row whose pivot vanishes lies in the span of those before it. It counts as implied only if the
same holds at a second, random point, values included: then it is dropped. Rows that contradict
the others are kept, for the solver to refuse and for the report to name.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from solver.nlp.assembly import Nlp
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Matrix = Any  # a scipy.sparse.csr_array; scipy ships no types

_PIVOT = 1e-9  # squared distance of a unit row to the span of the rows before it
_MATCH = 1e-7  # relative residual up to which a row equals a combination of others
_NUDGE = 1e-2  # of each variable's size: how far the test points lie from the guess


@dataclass(frozen=True, slots=True)
class Redundancy:
    """What is implied: positions of rows and of fixed variables, and how to call them.

    ``contradictions`` names equalities that depend on others but ask for another value.
    """

    rows: Indices
    fixed: Indices
    names: tuple[str, ...]
    contradictions: tuple[str, ...]


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

    def name(self, position: int) -> str:
        """How a report calls an equality."""
        if position < len(self.rows):
            return list(self.program.labels())[int(self.rows[position])].name
        index = self.fixed[position - len(self.rows)]
        for block in self.program.variables.blocks:
            if index in block.indices:
                row = int(np.argwhere(block.indices == index)[0, 0])
                return f"final {block.names[row]}"
        raise AssertionError(f"variable {index} stands in no block")


def find_redundancy(program: Program, scaling: Scaling, nlp: Nlp) -> Redundancy:
    """Equalities of the program that follow from the others."""
    equalities = _Equalities.of(program, scaling)
    rng = np.random.default_rng(0)
    nudges = _NUDGE * rng.standard_normal((2, program.variables.size))
    tests = [equalities.at(nlp, nudge) for nudge in nudges]
    suspects = _dependent_rows(tests[0][0])
    found: dict[bool, list[int]] = {True: [], False: []}
    for suspect in suspects:
        gaps = [_gaps(matrix, values, suspect, suspects) for matrix, values in tests]
        if all(direction < _MATCH for direction, _ in gaps):
            found[all(value < _MATCH for _, value in gaps)].append(suspect)
    implied, split = np.array(found[True], dtype=int), len(equalities.rows)
    return Redundancy(
        equalities.rows[implied[implied < split]],
        equalities.fixed[implied[implied >= split] - split],
        tuple(equalities.name(position) for position in found[True]),
        tuple(equalities.name(position) for position in found[False]),
    )


def _gram(matrix: Matrix) -> Any:
    """Factors of A A', in order, a trifle added to the diagonal."""
    gram = matrix @ matrix.T + 1e-14 * sparse.eye_array(matrix.shape[0])
    options = {"SymmetricMode": True}
    return splu(
        sparse.csc_array(gram), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options
    )


def _dependent_rows(matrix: Matrix) -> list[int]:
    """Rows in the span of those before them, by the pivots of A A'."""
    if matrix.shape[0] == 0 or not np.all(np.isfinite(matrix.data)):
        return []
    return [int(row) for row in np.flatnonzero(np.abs(_gram(matrix).U.diagonal()) < _PIVOT)]


def _gaps(matrix: Matrix, values: Array, row: int, suspects: Sequence[int]) -> tuple[float, float]:
    """How far a row, and its value, are from a combination of the rows that are no suspects."""
    others = np.setdiff1d(np.arange(matrix.shape[0]), np.array(suspects))
    basis, target = matrix[others], matrix[[row]].toarray().ravel()
    combination, rest = np.zeros(len(others)), target
    if len(others):
        factors = _gram(basis)
        for _ in range(3):  # iterative refinement: A A' has the square of A's condition
            combination = combination + factors.solve(basis @ rest)
            rest = target - basis.T @ combination
    return float(np.linalg.norm(rest)), float(abs(values[others] @ combination - values[row]))
