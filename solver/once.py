"""One problem from one guess to a judged result: its meshes, its switches, its certificate."""

import time
from collections.abc import Callable, Sequence

from schemas.problem import Problem
from schemas.results import Certificate, Solution, finite
from solver.certificate import CHECKS, JUDGED, certify
from solver.lowering import smoothed
from solver.meshes import SolvedMesh, solve_meshes, solve_switched
from solver.prepare import prepare
from solver.run import Run
from solver.solution.choose import choose
from solver.solution.conclude import conclude, snapshot

GRACE = 10.0
"""Seconds for the certificate, where the limit of the solve leaves less."""

Listen = Callable[[Solution], None]


def solve_once(problem: Problem, run: Run, listen: Listen) -> Solution:
    """Solve a problem that has neither stages nor several starts.

    Raises
    ------
    InvalidModel
        If the model has no finite value at the initial guess.
    EngineFault
        If the NLP solver itself fails.
    """
    smooth = smoothed(problem)
    solved = _solved(smooth, run, lambda so_far: listen(snapshot(problem, so_far, run)))
    with run.stage("certify"):
        certificate = _certificate(smooth, solved, run)
    return conclude(problem, solved, certificate, run)


def _solved(
    problem: Problem, run: Run, publish: Callable[[Sequence[SolvedMesh]], None]
) -> list[SolvedMesh]:
    """All meshes, as of the user's own phases."""
    with run.stage("build"):
        model, setting = prepare(problem)
    switches = problem.refinement is not None and problem.refinement.switches
    meshes = solve_switched if switches else solve_meshes
    return meshes(problem, model, setting, run, publish, warm=False)


def _certificate(problem: Problem, solved: Sequence[SolvedMesh], run: Run) -> Certificate:
    chosen = choose(problem, solved)
    checks = JUDGED if run.stopped() else CHECKS
    until = max(run.deadline, time.monotonic() + GRACE)
    objective = finite(chosen.objective)
    return certify(problem, chosen.phases, objective, checks, chosen.statics, until)
