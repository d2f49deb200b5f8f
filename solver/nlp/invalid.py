"""Where a program stops having values: beside the last iterate of a solve that met no number."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from solver.nlp.program import Program, RowLabel
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]

_STEPS = (1e-3, 1e-2, 1e-1, 1.0, 10.0)  # of each variable's size
_TRIES = 4


def find_invalid(program: Program, task: NlpTask, z: Array) -> list[RowLabel]:
    """The rows without a finite value or slope closest to the point ``z`` (n,), by name.

    Steps in random directions, ever longer, within the bounds; one label for each name and
    phase. Empty where none is found: then it is the objective, or farther away.
    """
    random = np.random.default_rng(0)
    for point in _around(task, z, random):
        bad = _broken(task, point)
        if bad.any():
            labels = list(program.labels())
            found = [labels[row] for row in np.flatnonzero(bad)]
            return list({(label.name, label.phase): label for label in reversed(found)}.values())[
                ::-1
            ]
    return []


def _around(task: NlpTask, z: Array, random: np.random.Generator) -> Iterator[Array]:
    size = np.maximum(np.abs(z), 1.0)
    yield np.clip(z, task.lower, task.upper)
    for step in _STEPS:
        for _ in range(_TRIES):
            aside = z + step * size * random.uniform(-1.0, 1.0, len(z))
            yield np.clip(aside, task.lower, task.upper)


def _broken(task: NlpTask, z: Array) -> NDArray[np.bool_]:
    """Rows (m,) that have no finite value there, or else no finite slope."""
    values, jacobian = task.nlp.jacobian(z, [])
    bad: NDArray[np.bool_] = ~np.isfinite(values.full().ravel())
    if not bad.any():
        rows = np.array(jacobian.row(), dtype=int)
        bad[rows[~np.isfinite(jacobian.nonzeros())]] = True
    return bad
