"""Scaling: every variable and row divided by its typical size, where that is far from 1."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.nlp.program import Program

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Scaling:
    """Typical sizes of variables (n,) and of rows (m,)."""

    columns: Array
    rows: Array


def typical_scaling(program: Program) -> Scaling:
    """The sizes that the program's blocks and rows state of themselves."""
    return Scaling(program.variables.gather("scale"), program.row_vector("magnitude", 1.0))


def typical_size(*samples: Array) -> Array:
    """The largest finite size in each row of the samples (names, any); 1 where it is near 1.

    Sizes within two decades of 1, and zero, count as 1: measured on the gallery, scaling those
    costs iterations, while not scaling the others costs many more and the optimum's basin.
    """
    stacked = np.concatenate([np.abs(sample) for sample in samples], axis=1)
    largest = np.max(np.where(np.isfinite(stacked), stacked, 0.0), axis=1, initial=0.0)
    plain = (largest == 0) | ((largest >= 1e-2) & (largest <= 1e2))
    return np.where(plain, 1.0, np.clip(largest, 1e-8, 1e8))
