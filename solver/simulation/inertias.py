"""Whether every coordinate of a mechanism has inertia: else nothing gives its acceleration."""

from collections.abc import Iterator

import numpy as np

from schemas.errors import Issue
from schemas.mechanisms import Prismatic
from schemas.pointers import pointer
from solver.numeric.tape import Array
from solver.simulation.multibody import Multibody

_TRIES = 3
_NOTHING = 1e-12
"""Masses below this share of the largest are none."""


def check_inertias(model: Multibody, start: Array) -> Iterator[Issue]:
    """An issue where the mass matrix is singular whatever the pose, or at the ``start`` (n,)."""
    poses = np.random.default_rng(0).normal(size=(len(start), _TRIES))
    found = [_lightest(matrix) for matrix in model.mass(poses)]
    if None not in found and found:
        yield _massless(model, found[0] or 0)
        return
    here = _lightest(model.mass(start))
    if here is not None:
        name = model.coordinates[here]
        yield Issue(
            "/initial",
            f"nothing gives the acceleration of '{name}' at the start: what it moves has no "
            "inertia about it in this pose",
            "start in another pose, or give the bodies that it carries an inertia",
        )


def _massless(model: Multibody, coordinate: int) -> Issue:
    """The body that the coordinate moves is the one that wants something."""
    name = model.coordinates[coordinate]
    link = next(one for one in model.mechanism.links if name in one.coordinates)
    straight = isinstance(link.joint, Prismatic) or name in (f"{link.body}.x", f"{link.body}.y")
    wanted = "mass" if straight else "inertia"
    return Issue(
        pointer("system", "bodies", link.body, wanted),
        f"nothing gives the acceleration of '{name}': what it moves has no {wanted}",
        f"give '{link.body}', or a body that it carries, {wanted} above 0",
    )


def _lightest(matrix: Array) -> int | None:
    """The coordinate that moves most where nothing resists; None where every motion is resisted."""
    diagonal = np.abs(np.diag(matrix))
    if not np.isfinite(matrix).all():
        return None
    if diagonal.min() <= _NOTHING * diagonal.max():
        return int(np.argmin(diagonal))
    size = np.sqrt(diagonal)
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    return None if values[0] > _NOTHING else int(np.argmax(np.abs(vectors[:, 0])))
