"""Scaling: every variable and row divided by its typical size, the objective by its own."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.nlp.program import Program

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scaling:
    """Typical sizes: of variables (n,), of rows (m,), of the objective."""

    columns: Array
    rows: Array
    objective: float = 1.0


def typical_scaling(program: Program) -> Scaling:
    """The sizes that the program's blocks and rows state of themselves."""
    return Scaling(program.variables.gather("scale"), program.row_vector("magnitude", 1.0))


def typical_size(*samples: Array) -> Array:
    """The largest finite size in each row of the samples (names, any), 1 where all are zero."""
    stacked = np.concatenate([np.abs(sample) for sample in samples], axis=1)
    largest = np.max(np.where(np.isfinite(stacked), stacked, 0.0), axis=1, initial=0.0)
    return np.where(largest > 0, np.clip(largest, 1e-3, 1e6), 1.0)
