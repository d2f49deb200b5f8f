"""Whether every coordinate of a mechanism has inertia: else nothing gives its acceleration."""

from collections.abc import Iterator

import numpy as np

from schemas.errors import Issue
from schemas.pointers import pointer
from solver.numeric.tape import Array
from solver.poses.tapes import Tapes

_TRIES, _NOTHING = 3, 1e-12


def check_inertias(tapes: Tapes, index: int) -> Iterator[Issue]:
    """An issue where the mass matrix is singular whatever the pose."""
    names = tapes.system.coordinates
    poses = np.random.default_rng(0).normal(size=(_TRIES, len(names)))
    found = _massless(tapes.masses(poses))
    if found is not None:
        name = names[found]
        yield Issue(
            pointer("phases", index, "system", "bodies"),
            f"nothing gives the acceleration of '{name}': what it moves has no inertia about it",
            "give the bodies that it carries an inertia, or move their mass away from the joint",
        )


def _massless(matrices: Array) -> int | None:
    """The coordinate that moves most where no pose resists; None where every motion is resisted."""
    if not np.isfinite(matrices).all():
        return None
    lightest = []
    for matrix in matrices:
        size = np.sqrt(np.maximum(np.abs(np.diag(matrix)), np.finfo(float).tiny))
        if np.abs(np.diag(matrix)).min() <= _NOTHING * np.abs(matrix).max():
            lightest.append(int(np.argmin(np.abs(np.diag(matrix)))))
            continue
        values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
        if values[0] > _NOTHING:
            return None
        lightest.append(int(np.argmax(np.abs(vectors[:, 0]))))
    return lightest[0]
