"""From mesh to mesh: solve, estimate the error, refine, until it is small enough."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from schemas.events import MeshSolved
from schemas.problem import Problem
from schemas.results import finite
from solver.backends import NlpStatus
from solver.certificate.case import certificate_tolerance
from solver.model import Model
from solver.refinement.curves import decay, seams
from solver.refinement.meshed import Meshed
from solver.refinement.refine import next_meshes
from solver.run import Run
from solver.solve_mesh import SolvedMesh, Start, solve_mesh
from solver.transcribe import Setting

_JUST_ABOVE = 1.01
_LOST = 0.1

Publish = Callable[[Sequence[SolvedMesh]], None]
"""Takes the meshes solved so far, the last of them perhaps unfinished."""


def solve_meshes(
    problem: Problem,
    model: Model,
    setting: Setting,
    run: Run,
    publish: Publish,
    *,
    warm: bool,
    enough: Callable[[SolvedMesh], bool] = lambda _: False,
) -> list[SolvedMesh]:
    """Solve on one mesh after the other, each from the last one's solution.

    ``warm`` says that the setting's guesses are nearly optimal; after a mesh that is ``enough``
    there is no other.
    """
    solved: list[SolvedMesh] = []
    start: Start | None = Start(0, setting, warm)
    while start is not None:
        mesh = solve_mesh(
            problem, model, start, run, lambda unfinished: publish([*solved, unfinished])
        )
        solved.append(_not_lost(mesh, solved))
        run.on_event(_event(problem, solved))
        publish(solved)
        start = None if enough(mesh) else _next(problem, start, solved, run)
    return solved


def _not_lost(mesh: SolvedMesh, before: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh; not optimal where it is much worse than a coarser one from which it started.

    The coarser optimum is nearly feasible on the finer mesh, which can only lower it. Where many
    orders of magnitude meet, as with fourth derivatives on very short segments, a solver may
    still end elsewhere and call it optimal.
    """
    if not before or not mesh.optimal or not before[-1].optimal:
        return mesh
    least = before[-1].objective
    if mesh.objective <= least + _LOST * (1 + abs(least)):
        return mesh
    return replace(mesh, outcome=replace(mesh.outcome, status=NlpStatus.DIVERGED))


def _next(problem: Problem, start: Start, solved: Sequence[SolvedMesh], run: Run) -> Start | None:
    """The next mesh, or None where this one is the last."""
    settings, last = problem.refinement, solved[-1]
    if settings is None or not last.optimal:
        return None
    allowed = 0.5 * certificate_tolerance(problem)  # of the integrals: half of what is judged
    if last.max_error <= settings.tolerance and (
        last.integral_error <= allowed or _stuck(solved, settings.tolerance)
    ):
        return None
    if len(solved) >= settings.max_iterations:
        return None
    with run.stage("refine"):
        meshes = next_meshes(_known(solved, settings.tolerance, allowed), settings, run.seconds())
    if meshes is None:
        return None
    setting = replace(
        start.setting,
        meshes=meshes,
        guesses=last.trajectories,
        statics=list(last.statics.values()),
    )
    return Start(start.number + 1, setting, warm=True)


def _stuck(solved: Sequence[SolvedMesh], tolerance: float) -> bool:
    """Whether the last mesh, made for the integrals' sake, was of little use to them."""
    if len(solved) < 2 or solved[-2].max_error > tolerance:
        return False
    return not solved[-1].integral_error < solved[-2].integral_error / 4


def _known(solved: Sequence[SolvedMesh], tolerance: float, allowed: float) -> list[Meshed]:
    """What refinement may know of each phase's last mesh.

    A segment whose share in the integrals is off by more than its part of what is ``allowed``
    counts as just above the tolerance: it is cut, but no finer than its states ask for.
    """
    last = solved[-1]
    share = allowed / sum(len(errors) for errors in last.errors)
    before = solved[-2].setting.meshes if len(solved) > 1 else [None] * len(last.phases)
    phases = []
    for transcription, mesh, own, sums, result, old in zip(
        last.setting.transcriptions,
        last.setting.meshes,
        last.errors,
        last.integral_errors,
        last.phases,
        before,
        strict=True,
    ):
        errors = np.where(sums > share, np.fmax(own, _JUST_ABOVE * tolerance), own)
        if transcription.rigid:  # nothing is cut where there is no error
            phases.append(Meshed(mesh, 0 * own, transcription.error_order))
            continue
        rates = None if mesh.degrees is None else decay(result, mesh.degrees)
        phases.append(Meshed(mesh, errors, transcription.error_order, seams(result), rates, old))
    return phases


def _event(problem: Problem, solved: Sequence[SolvedMesh]) -> MeshSolved:
    last = solved[-1]
    return MeshSolved(
        mesh=len(solved) - 1,
        segments=sum(len(errors) for errors in last.errors),
        max_error=finite(last.max_error),
        tolerance=problem.refinement.tolerance if problem.refinement else None,
        objective=finite(last.objective),
        nlp_iterations=last.outcome.iterations,
        seconds=last.seconds,
    )
