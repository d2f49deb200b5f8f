"""The next mesh of every phase: cut or raised where the error is too large, joined where small."""

from collections.abc import Sequence

import numpy as np

from schemas.problem import Refinement
from solver.mesh import Mesh
from solver.refinement.hp import hp
from solver.refinement.merge import joins
from solver.refinement.meshed import Flags, Meshed
from solver.refinement.subdivide import Counts, count_parts, keep_to


def next_meshes(
    phases: Sequence[Meshed], settings: Refinement, seconds: float = 0.0
) -> list[Mesh] | None:
    """The meshes to solve next, one for each phase.

    Parameters
    ----------
    phases
        The meshes just solved, and what is known of each.
    settings
        The caps hold for all phases together.
    seconds
        Spent so far; after ``settings.seconds`` there is no next mesh.

    Returns
    -------
    None where every error is within the tolerance, or where no room and no time are left.
    """
    if settings.seconds is not None and seconds >= settings.seconds:
        return None
    planned = [_plan(phase, settings) for phase in phases]
    joined = [
        joins(phase, settings.tolerance) & _single(parts)
        if settings.merge
        else np.zeros(phase.mesh.segments, dtype=bool)
        for phase, (parts, _) in zip(phases, planned, strict=True)
    ]
    errors = np.concatenate([phase.errors for phase in phases])
    room = settings.max_segments - len(errors) + sum(int(flags.sum()) for flags in joined)
    flat = keep_to(room, np.concatenate([parts for parts, _ in planned]), errors)
    bounds = np.cumsum([phase.mesh.segments for phase in phases])[:-1]
    meshes = [
        _apply(phase.mesh, parts, _kept(phase.mesh, parts, plan), flags)
        for phase, parts, plan, flags in zip(
            phases, np.split(flat, bounds), planned, joined, strict=True
        )
    ]
    grown = any(_grown(phase.mesh, mesh) for phase, mesh in zip(phases, meshes, strict=True))
    return meshes if grown else None


def _plan(phase: Meshed, settings: Refinement) -> tuple[Counts, Counts | None]:
    """Parts of each segment, and points of each of its parts where the method has degrees."""
    if phase.mesh.degrees is None:
        parts, points = count_parts(phase.errors, phase.order, settings), None
    else:
        parts, points = hp(phase, settings)
    return parts if phase.least is None else np.maximum(parts, phase.least), points


def _single(parts: Counts) -> Flags:
    """Where both the segment and the one on its left stay whole."""
    whole = parts == 1
    return np.asarray(whole & np.concatenate([[False], whole[:-1]]))


def _kept(mesh: Mesh, parts: Counts, plan: tuple[Counts, Counts | None]) -> Counts | None:
    """The planned points, but the old ones where there was no room for a cut."""
    planned, points = plan
    if points is None or mesh.degrees is None:
        return None
    return np.where((parts == 1) & (planned > 1), mesh.degrees, points)


def _apply(mesh: Mesh, parts: Counts, points: Counts | None, joined: Flags) -> Mesh:
    """The mesh with its new points, its joins and its cuts; a joined pair keeps its old points."""
    if points is not None and mesh.degrees is not None:
        paired = joined | np.concatenate([joined[1:], [False]])
        mesh = Mesh(mesh.knots, np.where(paired, mesh.degrees, points))
    firsts = np.flatnonzero(~joined)
    return mesh.join(firsts.tolist()).subdivide(parts[firsts])


def _grown(before: Mesh, after: Mesh) -> bool:
    """Whether the mesh after has knots, or points in a segment, that the one before has not."""
    if not np.isin(after.knots, before.knots).all():
        return True
    if before.degrees is None or after.degrees is None:
        return False
    held = np.searchsorted(before.knots, after.knots[:-1])
    return bool(np.any(after.degrees > before.degrees[held]))
