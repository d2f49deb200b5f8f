"""What a mesh still lacks where its states are accurate: limits, integrals, bends of controls."""

from collections.abc import Sequence

import numpy as np

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.certificate.case import certificate_tolerance
from solver.meshes.solve_mesh import SolvedMesh
from solver.refinement.curves import bends
from solver.refinement.merge import SEAM
from solver.refinement.subdivide import Array, Counts

_WITHIN = 0.1
"""How far curves may leave their limits, in tolerances of the certificate."""

_STEADY = 0.2
"""How little of what integrals may be off an objective still falls that has settled."""

_FELL = 0.5
"""What integrals are off by falls below that from mesh to mesh, where it depends on the mesh."""

_FEW = 40
"""Segments: where the parts would add more than these, and more than there are, each gets three."""


def demands(problem: Problem, solved: Sequence[SolvedMesh]) -> list[Counts]:
    """The parts of each segment, (segments,) per phase, that the states' errors do not ask for.

    Three things are measured that the mesh error does not see: how far the curves leave their
    limits between the nodes, how far the method's own sums are from the integrals, and how much
    the objective still changes while controls bend or jump inside of segments.
    """
    last, allowed, limit = solved[-1], _allowed(problem), _limit(problem)
    wanted = [np.ones(len(errors), dtype=int) for errors in last.errors]
    if last.largest_excess > limit:
        wanted = _largest(problem, wanted, [excess / limit for excess in last.excess])
    if last.integral_error > allowed:
        wanted = _largest(problem, wanted, _worst(shares(problem, solved)))
    if not _accurate(problem, last) or _steady(problem, solved, allowed):
        return _movable(last, wanted)
    bent = [(_bent(result) / SEAM) ** 2 for result in last.phases]
    return _movable(last, _largest(problem, wanted, bent))


def honest(problem: Problem, mesh: SolvedMesh) -> bool:
    """Whether the objective is what it seems: curves within limits, sums those of the curves."""
    within = mesh.largest_excess <= _limit(problem)
    return within and mesh.integral_error <= _allowed(problem)


def shares(problem: Problem, solved: Sequence[SolvedMesh]) -> list[Array]:
    """Each segment's error of the integrals over its equal part of the allowed, per phase.

    Zero where no cut makes them smaller.
    """
    errors = solved[-1].integral_errors
    count = sum(len(own) for own in errors)
    scale = 0.0 if _left_over(problem, solved) else count / _allowed(problem)
    return [_known(own * scale) for own in errors]


def _left_over(problem: Problem, solved: Sequence[SolvedMesh]) -> bool:
    """Whether integrals are off by more than allowed, but by what the solver leaves on segments.

    Slacks of absolute values are an example: off by as much on short segments as on long ones.
    """
    if len(solved) < 2:
        return False
    before, last = (mesh.integral_error for mesh in solved[-2:])
    count = sum(len(own) for own in solved[-1].integral_errors)
    return _allowed(problem) < last <= count * problem.solver.tolerance and last >= _FELL * before


def _allowed(problem: Problem) -> float:
    return 0.5 * certificate_tolerance(problem)


def _limit(problem: Problem) -> float:
    return _WITHIN * problem.certificate.constraint_tolerance


def _accurate(problem: Problem, mesh: SolvedMesh) -> bool:
    settings = problem.refinement
    return settings is not None and mesh.max_error <= settings.tolerance


def _steady(problem: Problem, solved: Sequence[SolvedMesh], allowed: float) -> bool:
    """Whether the last mesh, after an accurate one, did not lower the objective any more.

    Shorter segments leave a control more freedom; where the objective rises, it is not that.
    """
    if len(solved) < 2 or not _accurate(problem, solved[-2]):
        return False
    gain = solved[-2].objective - solved[-1].objective
    return gain <= _STEADY * allowed * (1 + abs(solved[-1].objective))


def _largest(problem: Problem, wanted: Sequence[Counts], ratios: Sequence[Array]) -> list[Counts]:
    """The larger of both: what ``ratios`` to the allowed ask for falls with the length squared."""
    most = problem.refinement.max_subdivisions if problem.refinement else 1
    return [
        np.maximum(parts, np.where(ratio > 1, np.clip(np.ceil(np.sqrt(ratio)), 3, most), 1)).astype(
            int
        )
        for parts, ratio in zip(wanted, map(_known, ratios), strict=True)
    ]


def _known(ratios: Array) -> Array:
    return np.nan_to_num(ratios, nan=np.inf, posinf=np.inf)


def _worst(ratios: Sequence[Array]) -> list[Array]:
    """The shares of the segments that make up nearly all, zero for the others.

    These together are off by half of the allowed or by a tenth of all.
    """
    flat = np.concatenate(ratios)
    order = np.argsort(flat)
    small = np.cumsum(flat[order]) <= max(0.5 * len(flat), 0.1 * float(flat.sum()))
    flat[order[small]] = 0.0
    return np.split(flat, np.cumsum([len(own) for own in ratios])[:-1])


def _bent(result: PhaseResult) -> Array:
    """How far controls bend or jump at the knots of each segment, relative to their range."""
    apart = np.concatenate([[0.0], bends(result), [0.0]])
    return np.asarray(np.maximum(apart[:-1], apart[1:]))


def _movable(mesh: SolvedMesh, wanted: Sequence[Counts]) -> list[Counts]:
    """Nothing is cut where the method's mesh is rigid."""
    rigid = [method.rigid for method in mesh.setting.transcriptions]
    parts = [np.where(stiff, 1, own) for stiff, own in zip(rigid, wanted, strict=True)]
    added = sum(int(np.sum(own - 1)) for own in parts)
    most = 3 if added > max(_FEW, sum(len(own) for own in parts)) else None
    return [np.clip(own, None, most) for own in parts]
