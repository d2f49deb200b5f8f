"""From mesh to mesh: solve, estimate the error, refine, until it is small enough."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from schemas.events import MeshSolved
from schemas.methods import ContactImplicit
from schemas.problem import Problem
from schemas.results import PhaseResult, finite
from solver.backends import NlpStatus
from solver.contact.changes import changes
from solver.mesh import Mesh
from solver.meshes.demands import demands, honest, shares
from solver.meshes.solve_mesh import Array, SolvedMesh, Start, solve_mesh
from solver.model import Model
from solver.refinement.curves import decay, seams
from solver.refinement.meshed import Meshed
from solver.refinement.refine import next_meshes
from solver.run import Run
from solver.transcribe import Setting

_LOST = 0.1
"""A mesh is lost whose objective is so much higher than that of a coarser one, relative, and
higher than what the integrals of that one were off."""

_RISES = 30
"""In tolerances: the same after an accurate mesh."""

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
        solved.append(_not_lost(problem, mesh, solved))
        run.on_event(_event(problem, solved))
        publish(solved)
        start = None if enough(mesh) else _next(problem, start, solved, run)
    return solved


def _not_lost(problem: Problem, mesh: SolvedMesh, before: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh; not optimal where it is worse than a coarser one from which it started.

    The coarser optimum is nearly feasible on the finer mesh, which can only lower it; very nearly
    where the coarser mesh is accurate and its objective that of its curves. A solver may still end
    elsewhere and call it optimal.
    """
    settings = problem.refinement
    if mesh.stepped:  # what coarse steps lose, or gain, is no measure for finer ones
        return mesh
    if settings is None or not before or not mesh.optimal or not before[-1].optimal:
        return mesh
    last = before[-1]
    rise = _LOST + np.nan_to_num(last.integral_error, nan=np.inf)
    if last.max_error <= settings.tolerance and honest(problem, last):
        rise = min(_LOST, _RISES * settings.tolerance)
    if mesh.objective <= last.objective + rise * (1 + abs(last.objective)):
        return mesh
    return replace(mesh, outcome=replace(mesh.outcome, status=NlpStatus.DIVERGED))


def _next(problem: Problem, start: Start, solved: Sequence[SolvedMesh], run: Run) -> Start | None:
    """The next mesh, or None where this one is the last."""
    settings, last = problem.refinement, solved[-1]
    if settings is None or not last.optimal or len(solved) >= settings.max_iterations:
        return None
    with run.stage("refine"):
        meshes = next_meshes(_known(problem, solved), settings, run.seconds())
    if meshes is None:
        return None
    setting = replace(
        start.setting,
        meshes=meshes,
        guesses=last.trajectories,
        statics=list(last.statics.values()),
    )
    spare = last.max_error <= settings.tolerance
    return Start(start.number + 1, setting, warm=True, spare=spare, implied=last.redundancy)


def _known(problem: Problem, solved: Sequence[SolvedMesh]) -> list[Meshed]:
    """What refinement may know of each phase's last mesh."""
    last = solved[-1]
    before = solved[-2].setting.meshes if len(solved) > 1 else [None] * len(last.phases)
    phases = []
    for transcription, mesh, errors, least, own, result, old in zip(
        last.setting.transcriptions,
        last.setting.meshes,
        last.errors,
        demands(problem, solved),
        shares(problem, solved),
        last.phases,
        before,
        strict=True,
    ):
        if transcription.stepped:
            phases.append(_halved(problem, mesh, errors, result))
            continue
        if transcription.rigid:  # nothing is cut where there is no error
            phases.append(Meshed(mesh, 0 * errors, transcription.error_order))
            continue
        rates = None if mesh.degrees is None else decay(result, mesh.degrees)
        phases.append(
            Meshed(mesh, errors, transcription.error_order, seams(result), rates, old, least, own)
        )
    return phases


def _halved(problem: Problem, mesh: Mesh, losses: Array, result: PhaseResult) -> Meshed:
    """Time steps are halved all alike: what they lose falls with their length.

    Where that is asked for, twice in which contacts change.
    """
    allowed = problem.refinement.tolerance if problem.refinement else np.inf
    least = np.full(mesh.segments, 1 if np.sum(losses) <= allowed else 2)
    spec = next(phase for phase in problem.phases if phase.name == result.name)
    if isinstance(spec.method, ContactImplicit) and spec.method.split_changes:
        least[changes(result)] *= int(least[0])
    return Meshed(mesh, 0 * losses, 1, least=least)


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
