"""Equality constraints that others imply: found by the rank of the Jacobian, dropped, reported.

A redundant row leaves the multipliers undetermined and breaks most solvers. The equality rows,
and as rows of their own the values fixed at the end of each phase, are factorised in order; a
row whose pivot vanishes is suspected to lie in the span of those before it. It counts as implied
if it does so at two random points near the guess, values included: then it is dropped. Rows that
contradict the others are kept, for the solver to refuse and for the report to name. Inequalities
whose value the equalities decide are dropped, too (``decided.py``), without a word: they hold.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.nlp.assembly import Nlp
from solver.nlp.decided import decided_rows, settled_rows
from solver.nlp.program import Program, RowLabel
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

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
    another value. ``places`` say where the rows are, then the values.
    """

    rows: Indices
    fixed: Indices
    decided: Indices
    names: tuple[str, ...]
    conflicts: tuple[str, ...]
    places: tuple[RowLabel, ...] = ()


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
        order = _in_time(program)
        return cls(program, scaling, order[(lower == upper)[order]], fixed, pinned)

    def at(self, nlp: Nlp, nudge: Array) -> tuple[ca.DM, Array]:
        """Their Jacobian, each row of unit length, and their values, near the guess."""
        variables, scale = self.program.variables, self.scaling.columns
        lower = variables.gather("lower") / scale
        z = variables.gather("guess") / scale + nudge
        # At their values: what is bilinear in them, such as J(q) v of a foot at rest, is then 0.
        for known in (self.pinned, self.fixed):
            z[known] = lower[known]
        rows, jacobian = nlp.jacobian(z, [])
        targets = self.program.row_vector("lower", 0.0) / self.scaling.rows
        values = [(rows.full().ravel() - targets)[self.rows], (z - lower)[self.fixed]]
        held = ca.Sparsity.triplet(
            len(self.fixed), len(z), list(range(len(self.fixed))), self.fixed.tolist()
        )
        free = np.setdiff1d(np.arange(len(z)), self.pinned)
        whole = ca.vertcat(jacobian[self.rows.tolist(), :], ca.DM(held, 1.0))
        matrix = whole[:, free.tolist()]
        length = np.sqrt(ca.sum2(matrix**2).full().ravel())
        length = np.where(length > 0, length, 1.0)
        return ca.mtimes(ca.diag(ca.DM(1 / length)), matrix), np.concatenate(values) / length

    def shared(self) -> NDArray[np.bool_]:
        """Columns of the Jacobian that many rows may use: variables at no node, such as times."""
        anywhere = np.zeros(self.program.variables.size, dtype=bool)
        for block in self.program.variables.blocks:
            anywhere[block.indices[:, np.isnan(block.fractions)]] = True
        return np.delete(anywhere, self.pinned)

    def names(self, positions: Indices) -> tuple[str, ...]:
        """How a report calls some equalities, each name once."""
        if len(positions) == 0:
            return ()
        called = self.places()
        return tuple(dict.fromkeys(called[position].name for position in positions))

    def places(self) -> list[RowLabel]:
        """What each is, and where."""
        labels = list(self.program.labels())
        final = {
            int(index): RowLabel(f"final {name}", block.phase, 1.0)
            for block in self.program.variables.blocks
            for name, indices in zip(block.names, block.indices, strict=True)
            for index in indices
        }
        return [labels[row] for row in self.rows] + [final[index] for index in self.fixed]


def _in_time(program: Program) -> Indices:
    """All rows in the order of phases and time, those that tie ends last.

    Neighbours in time share variables: in this order a factorisation does not fill.
    """
    keys = [
        np.stack([np.full(where.size, phase), where])
        for group in program.groups
        for where, phase in [(group.rows.fractions.T.ravel(), group.phase or 0)]
    ]
    sums = np.full((2, len(program.sum_names)), np.nan)
    phase, where = np.concatenate([*keys, sums], axis=1)
    return np.lexsort((where, phase, np.isnan(where)))


def find_redundancy(
    program: Program,
    scaling: Scaling,
    nlp: Nlp,
    settled: Sequence[Mapping[str, frozenset[float]]] = (),
    before: Redundancy | None = None,
) -> Redundancy:
    """Equalities of the program that follow from the others, inequalities that they decide.

    ``settled`` are those that the model knows of, for each phase (``decided.settled_rows``).
    ``before`` is what was found on another mesh: what is implied at ends of phases is so on all
    meshes, and need not be found anew.
    """
    equalities = _Equalities.of(program, scaling)
    decided = np.union1d(decided_rows(program, scaling, nlp), settled_rows(program, settled))
    if before is not None and not before.conflicts and all(map(_at_end, before.places)):
        return _again(before, equalities, decided)
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
        decided,
        equalities.names(implied),
        equalities.names(suspects[spanned & ~agree]),
        _places(equalities, implied),
    )


def _places(equalities: _Equalities, positions: Indices) -> tuple[RowLabel, ...]:
    if len(positions) == 0:
        return ()
    known = equalities.places()
    return tuple(known[position] for position in positions)


def _at_end(place: RowLabel) -> bool:
    return not 0.0 < place.fraction < 1.0


def _again(before: Redundancy, equalities: _Equalities, decided: Indices) -> Redundancy:
    """The same on another mesh."""
    implied = np.array([], dtype=int)
    if before.places:
        wanted = {_key(place) for place in before.places}
        known = map(_key, equalities.places())
        implied = np.array([i for i, key in enumerate(known) if key in wanted], dtype=int)
    split = len(equalities.rows)
    return Redundancy(
        equalities.rows[implied[implied < split]],
        equalities.fixed[implied[implied >= split] - split],
        decided,
        before.names,
        (),
        before.places,
    )


def _key(place: RowLabel) -> tuple[str, int | None, str]:
    return place.name, place.phase, repr(place.fraction)  # where there is no time it is NaN


def _dependent_rows(matrix: ca.DM, values: Array, shared: NDArray[np.bool_]) -> Indices:
    """Rows in the span of the others, of a dependent set the last ones.

    A column that all rows use would fill A A', at the price of its rank cubed; so the pivots are
    taken without the shared ones. That suspects too many, at most one for each such column.
    """
    if not matrix.is_regular():
        return np.array([], dtype=int)
    suspects = _vanishing_pivots(matrix[:, np.flatnonzero(~shared).tolist()])
    for _ in range(int(shared.sum())):
        outside = np.flatnonzero(_deviations(matrix, values, suspects)[0] >= _MATCH)
        if len(outside) == 0:
            break
        suspects = np.delete(suspects, outside[0])
    return suspects


def _vanishing_pivots(matrix: ca.DM) -> Indices:
    """Rows in the span of those before them, by the pivots of A A' in order."""
    if matrix.shape[0] == 0:
        return np.array([], dtype=int)
    gram = ca.mtimes(matrix, matrix.T) + _TRIFLE * ca.DM.eye(matrix.shape[0])
    pivots, *_ = ca.ldl(gram, False)
    return np.flatnonzero(np.abs(pivots.full().ravel()) < _PIVOT)


def _deviations(matrix: ca.DM, values: Array, rows: Indices) -> tuple[Array, Array]:
    """How far rows (k,), and their values, are from the nearest combinations of all others.

    Least squares by the augmented system [I B'; B 0], which full columns of B do not fill.
    """
    if len(rows) == 0:
        return np.empty(0), np.empty(0)
    # Most programs never get here, and scipy takes longer to load than they to be solved.
    from scipy import sparse  # noqa: PLC0415 - see above
    from scipy.sparse.linalg import splu  # noqa: PLC0415

    if not matrix.is_regular():
        return np.full(len(rows), np.inf), np.full(len(rows), np.inf)
    others = np.setdiff1d(np.arange(matrix.shape[0]), rows)
    everything = sparse.csr_array(matrix.sparse())
    basis, width = everything[others], matrix.shape[1]
    corner = -_TRIFLE * sparse.eye_array(len(others))
    system = sparse.block_array([[sparse.eye_array(width), basis.T], [basis, corner]]).tocsc()
    try:
        factors = splu(system)
    except RuntimeError as error:
        if "MALLOC" in str(error):  # SuperLU's own way to say so
            raise MemoryError("the search for implied equalities ran out of memory") from error
        raise
    distances, gaps = [], []
    for some in np.array_split(rows, -(-len(rows) // _AT_ONCE)):
        targets = everything[some].toarray().T
        padded = np.concatenate([targets, np.zeros((len(others), len(some)))])
        combinations = factors.solve(padded)[width:]
        distances.append(np.linalg.norm(targets - basis.T @ combinations, axis=0))
        gaps.append(np.abs(values[others] @ combinations - values[some]))
    return np.concatenate(distances), np.concatenate(gaps)
