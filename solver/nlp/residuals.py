"""Violated constraints by name, the worst first: what an infeasible result explains itself with."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.nlp.program import Program
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]


_NEGLIGIBLE = 1e-10  # relative: rounding, no violation


@dataclass(frozen=True, slots=True)
class RowResidual:
    """A violated row or bound. ``value`` is in its own unit, ``relative`` per typical size.

    A row without a finite value is the worst there is: ``relative`` is infinite.
    """

    name: str
    phase: int | None
    fraction: float
    value: float
    relative: float


def ranked_residuals(
    program: Program, scaling: Scaling, w: Array, rows: Array, most: int = 10
) -> list[RowResidual]:
    """The largest violations at the point ``w`` (SI) with row values ``rows`` (SI).

    One entry per name and phase: the worst of its nodes.
    """
    found: dict[tuple[str, int | None], RowResidual] = {}
    for residual in [*_row_residuals(program, scaling, rows), *_bound_residuals(program, w)]:
        if residual.relative < _NEGLIGIBLE:
            continue
        key = (residual.name, residual.phase)
        if key not in found or residual.relative > found[key].relative:
            found[key] = residual
    return sorted(found.values(), key=lambda residual: -residual.relative)[:most]


def _row_residuals(program: Program, scaling: Scaling, rows: Array) -> Iterator[RowResidual]:
    lower, upper = program.row_vector("lower", 0.0), program.row_vector("upper", 0.0)
    value = np.maximum(np.maximum(lower - rows, rows - upper), 0.0)
    labels = list(program.labels())
    for i in np.flatnonzero(~(value <= 0)):
        label = labels[i]
        size = float(value[i] / scaling.rows[i]) if np.isfinite(value[i]) else np.inf
        yield RowResidual(label.name, label.phase, label.fraction, float(value[i]), size)


def _bound_residuals(program: Program, w: Array) -> Iterator[RowResidual]:
    for block in program.variables.blocks:
        values = w[block.indices]
        excess = np.maximum(np.maximum(block.lower - values, values - block.upper), 0.0)
        for row, column in np.argwhere(excess > 0):
            if block.names[row].startswith("#"):  # the relaxation, which a homotopy moves
                continue
            yield RowResidual(
                f"bound {block.names[row]}",
                block.phase,
                float(block.fractions[column]),
                float(excess[row, column]),
                float(excess[row, column] / block.scale[row, column]),
            )
