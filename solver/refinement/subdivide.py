"""Where to cut: the order-based number of parts of each segment (003, equation 8.22)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from schemas.problem import Refinement
from solver.mesh import Mesh

Array = NDArray[np.float64]

KAPPA = 0.1
"""The safety factor of 8.22: aim at a tenth of the tolerance."""


def refine(
    meshes: Sequence[Mesh], errors: Sequence[Array], order: int, settings: Refinement
) -> list[Mesh] | None:
    """Cut every segment of every phase whose error is above the tolerance.

    A segment of error e gets ceil((e / (kappa * tolerance))^(1 / order)) parts, two at the least
    and ``settings.max_subdivisions`` at the most; an error that is not a number counts as the
    largest. Where that would pass ``settings.max_segments`` the worst segments are halved, as
    many as there is room for. None where there is no room at all.
    """
    flat = np.nan_to_num(np.concatenate(errors), nan=np.inf, posinf=np.inf)
    parts = np.where(flat > settings.tolerance, _parts(flat, order, settings), 1)
    room = settings.max_segments - len(flat)
    if room <= 0:
        return None
    if np.sum(parts - 1) > room:
        worst = np.argsort(-flat, kind="stable")[:room]
        parts = np.where(np.isin(np.arange(len(flat)), worst) & (parts > 1), 2, 1)
    splits = np.split(parts, np.cumsum([mesh.segments for mesh in meshes])[:-1])
    return [mesh.subdivide(own) for mesh, own in zip(meshes, splits, strict=True)]


def _parts(errors: Array, order: int, settings: Refinement) -> NDArray[np.int_]:
    wanted = np.ceil((errors / (KAPPA * settings.tolerance)) ** (1.0 / order))
    return np.clip(wanted, 2, settings.max_subdivisions).astype(int)
