"""The whole story on one page: problem -> model -> meshes -> certificate -> solution."""

import math
import time
from collections.abc import Callable
from dataclasses import replace

from schemas.events import EngineEvent, MeshSolved
from schemas.problem import Problem
from schemas.results import Solution, finite
from solver.certificate import CHECKS, JUDGED, certify
from solver.prepare import prepare
from solver.refinement.subdivide import refine
from solver.run import Run
from solver.solution.choose import choose
from solver.solution.conclude import conclude, snapshot
from solver.solve_mesh import SolvedMesh, Start, solve_mesh


def _ignore(_: object) -> None:
    """Take no notice."""


def _never() -> bool:
    return False


def solve(
    problem: Problem,
    on_event: Callable[[EngineEvent], None] = _ignore,
    deadline: float | None = None,
    should_stop: Callable[[], bool] = _never,
    on_snapshot: Callable[[Solution], None] = _ignore,
) -> Solution:
    """Solve a checked problem.

    Parameters
    ----------
    problem
        As ``schemas.reading.read_problem`` gives it.
    on_event
        Called with every stage, NLP iteration and solved mesh.
    deadline
        When to end at the latest, in seconds of ``time.monotonic``; the problem's own limit
        counts too.
    should_stop
        Asked at every NLP iteration; true ends the solve with the best iterate.
    on_snapshot
        Called with an uncertified solution after each mesh and, in long solves, about every
        second, so that a killed solve leaves one.

    Returns
    -------
    The solution, whatever its status. Its times are SI seconds of the motion.

    Raises
    ------
    InvalidModel
        If the model has no finite value at the initial guess.
    EngineFault
        If the NLP solver itself fails.
    """
    limit = time.monotonic() + problem.limits.seconds
    run = Run(on_event, min(limit, math.inf if deadline is None else deadline), should_stop)
    with run.stage("build"):
        model, setting = prepare(problem)

    solved: list[SolvedMesh] = []

    def publish(*unfinished: SolvedMesh) -> None:
        on_snapshot(snapshot(problem, [*solved, *unfinished], run))

    start: Start | None = Start(0, setting, warm=False)
    while start is not None:
        solved.append(solve_mesh(problem, model, start, run, publish))
        on_event(_mesh_event(problem, solved))
        publish()
        start = _next(problem, start, solved[-1])

    with run.stage("certify"):
        chosen = choose(solved)
        checks = JUDGED if run.stopped() else CHECKS
        certificate = certify(problem, chosen.phases, finite(chosen.objective), checks, chosen.statics)
    return conclude(problem, solved, certificate, run)


def _next(problem: Problem, start: Start, last: SolvedMesh) -> Start | None:
    """The next mesh, or None where this one is the last."""
    settings = problem.refinement
    if settings is None or not last.optimal or last.max_error <= settings.tolerance:
        return None
    if start.number + 1 >= settings.max_iterations:
        return None
    meshes = refine(start.setting.meshes, last.errors, start.setting.transcriptions[0].error_order, settings)
    if meshes is None:
        return None
    values = list(last.statics.values())
    setting = replace(start.setting, meshes=meshes, guesses=last.trajectories, statics=values)
    return Start(start.number + 1, setting, warm=True)


def _mesh_event(problem: Problem, solved: list[SolvedMesh]) -> MeshSolved:
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
