"""The distinct minima among solutions of one problem from several guesses."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas.results import Minimum, PhaseResult, Solution, SolutionStatus

Array = NDArray[np.float64]

FOUND = (
    SolutionStatus.CONVERGED,
    SolutionStatus.MESH_LIMIT,
    SolutionStatus.CERTIFICATE_FAILED,
    SolutionStatus.ACCEPTABLE,
)
"""What counts as a motion that was found, the surest first."""

SAME_OBJECTIVE = 1e-6
"""Relative to one plus its size; the meshes' own errors are added to it."""

SAME_CURVES = 1e-2
"""How far the states of one minimum may be apart, relative to their range: where the objective is
flat, solutions of the same objective differ by its root."""

_FRACTIONS = np.linspace(0.0, 1.0, 65)


def distinct(found: Iterable[tuple[int, Solution]]) -> list[Minimum]:
    """The different motions among solutions, the best first, each with the seeds that led to it.

    Parameters
    ----------
    found
        Seeds and solutions; those that found no motion are left out.

    Two solutions are one minimum where both their objectives and their states agree. It is
    reported as the surest of its solutions has it, the first one of these.
    """
    motions = [(seed, solution) for seed, solution in found if solution.status in FOUND]
    groups: list[list[tuple[int, Solution]]] = []
    for seed, solution in sorted(motions, key=lambda pair: rank(pair[1])):
        own = (group for group in groups if same(group[0][1], solution))
        group = next(own, None)
        if group is None:
            groups.append([(seed, solution)])
        else:
            group.append((seed, solution))
    minima = [_minimum(group) for group in groups]
    return sorted(minima, key=lambda minimum: _size(minimum.objective))


def rank(solution: Solution) -> tuple[int, float]:
    """Sorts solutions: by how sure they are, then by the objective."""
    place = FOUND.index(solution.status) if solution.status in FOUND else len(FOUND)
    return place, _size(solution.objective)


def same(one: Solution, two: Solution) -> bool:
    """Whether two solutions are the same minimum."""
    a, b = _size(one.objective), _size(two.objective)
    slack = SAME_OBJECTIVE + _mesh_error(one) + _mesh_error(two)
    if not abs(a - b) <= slack * (1 + min(abs(a), abs(b))):
        return False
    return len(one.phases) == len(two.phases) and all(
        _close(*pair) for pair in zip(one.phases, two.phases, strict=True)
    )


def _size(objective: float | None) -> float:
    return math.inf if objective is None else objective


def _mesh_error(solution: Solution) -> float:
    """The error of the last mesh."""
    meshes = solution.mesh_refinement.iterations
    return (meshes[-1].max_error if meshes else None) or 0.0


def _close(one: PhaseResult, two: PhaseResult) -> bool:
    if one.name != two.name or set(one.curves) != set(two.curves):
        return False
    lengths = one.knots[-1] - one.knots[0], two.knots[-1] - two.knots[0]
    if abs(lengths[0] - lengths[1]) > SAME_CURVES * max(lengths):
        return False
    a, b = _sampled(one), _sampled(two)
    if a.shape != b.shape:
        return False
    span = np.ptp(np.concatenate([a, b], axis=1), axis=1)
    size = np.maximum(span, SAME_CURVES * np.abs(a).max(axis=1))
    return bool(np.all(np.abs(a - b).max(axis=1) <= SAME_CURVES * size))


def _sampled(phase: PhaseResult) -> Array:
    """The states at the same fractions of the phase, (states, fractions)."""
    curves = Curves.from_dict(phase.curves["states"].model_dump())
    first, last = curves.breaks[0], curves.breaks[-1]
    values: Sequence[Array] = list(curves.sample(first + (last - first) * _FRACTIONS).values())
    return np.array(values)


def _minimum(group: Sequence[tuple[int, Solution]]) -> Minimum:
    solution = group[0][1]
    return Minimum(
        objective=solution.objective,
        status=solution.status,
        verdict=solution.certificate.verdict,
        seeds=sorted(seed for seed, _ in group),
        static=solution.static,
        phases=[phase.model_copy(update={"frames": None}) for phase in solution.phases],
    )
