"""Inequalities at the ends of phases that leave no room: the equalities there decide their value.

A leg of length 1 may start at its greatest length, 1; a foot that must bear weight takes off where
it bears none. Both hold, but nothing lies strictly inside of them, and an interior-point method
that is promised an inside drives their multipliers to infinity and loses its barrier parameter.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from solver.nlp.assembly import Nlp
from solver.nlp.program import Program
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

_MATCH = 1e-7  # scaled: how far values, and a row of unit length, may be off
_NUDGE = 1e-2  # of each variable's size: how far the test points lie from the guess
_ROUND_OFF = 1e-12  # of a fraction


def settled_rows(program: Program, settled: Sequence[Mapping[str, frozenset[float]]]) -> Indices:
    """Rows that the model itself knows to leave no room: for each phase, label -> fractions."""
    if not any(settled):
        return np.array([], dtype=int)
    found = [
        row
        for row, label in enumerate(program.labels())
        if label.phase is not None
        and any(
            abs(label.fraction - where) <= _ROUND_OFF
            for where in settled[label.phase].get(label.name, ())
        )
    ]
    return np.array(found, dtype=int)


def decided_rows(program: Program, scaling: Scaling, nlp: Nlp) -> Indices:
    """Inequalities at ends that hold wherever the ends' fixed values and equalities do.

    A row counts if, at two points near the guess, its gradient is a combination of those of the
    equalities, its value there follows from theirs, is the same, and within its limits.
    """
    lower, upper = (program.row_vector(side, 0.0) / scaling.rows for side in ("lower", "upper"))
    at_end = _at_ends(program)
    rows, anchors = (
        np.flatnonzero(at_end & (lower < upper)),
        np.flatnonzero(at_end & (lower == upper)),
    )
    if len(rows) == 0:
        return rows
    found = [
        _implied(nlp, z, free, rows, anchors, lower[anchors])
        for z, free in _points(program, scaling)
    ]
    values = np.array([value for value, _ in found])
    decided = np.all([off <= _MATCH for _, off in found], axis=0)
    decided &= np.ptp(values, axis=0) <= _MATCH
    decided &= np.all((values >= lower[rows] - _MATCH) & (values <= upper[rows] + _MATCH), axis=0)
    return rows[decided]


def _at_ends(program: Program) -> NDArray[np.bool_]:
    """Which rows lie at the start or end of a phase, or tie such; lifted integrals do not."""
    places = [group.rows.fractions.T.ravel() for group in program.groups]
    places.append(np.full(len(program.sum_names), 0.5))
    fractions = np.concatenate(places)
    inner = (fractions > _ROUND_OFF) & (fractions < 1 - _ROUND_OFF)
    return np.asarray(~inner)


def _points(program: Program, scaling: Scaling) -> Iterator[tuple[Array, Indices]]:
    """Two points near the guess, fixed variables at their values, and which are free."""
    variables = program.variables
    lower, upper = variables.gather("lower"), variables.gather("upper")
    held, rng = lower == upper, np.random.default_rng(0)
    for _ in range(2):
        z = variables.gather("guess") / scaling.columns
        z += _NUDGE * rng.standard_normal(variables.size)
        yield np.where(held, lower / scaling.columns, z), np.flatnonzero(~held)


def _implied(
    nlp: Nlp, z: Array, free: Indices, rows: Indices, anchors: Indices, targets: Array
) -> tuple[Array, Array]:
    """The values (k,) of rows where the anchors hold, and how far they are from following."""
    values, jacobian = nlp.jacobian(z, [])
    both, g = jacobian[[*rows.tolist(), *anchors.tolist()], :], values.full().ravel()
    used = np.intersect1d(np.flatnonzero(np.diff(both.colind())), free)
    own, basis = np.split(both[:, used.tolist()].full(), [len(rows)])
    if not (np.isfinite(own).all() and np.isfinite(basis).all() and np.isfinite(g).all()):
        return np.zeros(len(rows)), np.full(len(rows), np.inf)
    combinations = np.linalg.lstsq(basis.T, own.T, rcond=None)[0]
    off = np.linalg.norm(own - combinations.T @ basis, axis=1)
    length = np.maximum(np.linalg.norm(own, axis=1), _MATCH)
    return g[rows] - combinations.T @ (g[anchors] - targets), off / length
