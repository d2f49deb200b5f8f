"""One problem from one guess to a judged result: its meshes, its switches, its certificate."""

import time
from collections.abc import Callable, Sequence

from schemas.problem import Problem
from schemas.results import Certificate, Solution, finite
from solver.certificate import CHECKS, JUDGED, certify
from solver.hybrid import as_posted
from solver.meshes import SolvedMesh, solve_meshes, solve_switched
from solver.posing import Posing
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
    with run.stage("build"):
        posing = Posing.of(problem)

    def publish(so_far: Sequence[SolvedMesh]) -> None:
        guesses = so_far[0].setting.guesses
        listen(posing.told(snapshot(posing.shown, so_far, run), guesses))

    with as_posted(problem, posing.expansion):
        solved = _solved(posing, run, publish)
    with run.stage("certify"):
        certificate = _certificate(posing.judged, solved, run)
    solution = conclude(posing.shown, solved, certificate, run)
    return posing.told(solution, solved[0].setting.guesses)


def _solved(
    posing: Posing, run: Run, publish: Callable[[Sequence[SolvedMesh]], None]
) -> list[SolvedMesh]:
    """All meshes, as of the phases and modes of the problem."""
    problem = posing.solved
    with run.stage("build"):
        model, setting = posing.prepared()
    switches = problem.refinement is not None and problem.refinement.switches
    meshes = solve_switched if switches else solve_meshes
    return meshes(problem, model, setting, run, publish, warm=False)


def _certificate(problem: Problem, solved: Sequence[SolvedMesh], run: Run) -> Certificate:
    chosen = choose(problem, solved)
    checks = JUDGED if run.stopped() else CHECKS
    until = max(run.deadline, time.monotonic() + GRACE)
    objective = finite(chosen.objective)
    return certify(problem, chosen.phases, objective, checks, chosen.statics, until)
