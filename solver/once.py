"""One problem from one guess to a judged result: its meshes, its switches, its certificate."""

import time
from collections.abc import Callable, Sequence

from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import Certificate, Solution, finite
from solver.certificate import CHECKS, JUDGED, certify
from solver.hybrid import Expansion, as_posted, expand, mode_guesses, mode_sequence
from solver.lowering import smoothed
from solver.mechanics import limited
from solver.meshes import SolvedMesh, solve_meshes, solve_switched
from solver.model import Model
from solver.poses import loosened
from solver.prepare import prepare
from solver.run import Run
from solver.solution.choose import choose
from solver.solution.conclude import conclude, snapshot
from solver.trajectory import Trajectory

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
        expansion = expand(problem)
    smooth = loosened(limited(smoothed(expansion.problem)))

    def guess(model: Model) -> list[Trajectory]:
        return mode_guesses(expansion, problem, model)

    def publish(so_far: Sequence[SolvedMesh]) -> None:
        listen(_told(expansion, problem, snapshot(expansion.problem, so_far, run)))

    with as_posted(problem, expansion):
        solved = _solved(smooth, guess, run, publish)
    with run.stage("certify"):
        certificate = _certificate(smooth, solved, run)
    return _told(expansion, problem, conclude(expansion.problem, solved, certificate, run))


def _told(expansion: Expansion, problem: Problem, solution: Solution) -> Solution:
    """What the user learns of the modes; the hash is that of what was posted."""
    if expansion.problem is problem:
        return solution
    digest = solution.reproduce.model_copy(update={"spec_sha256": spec_sha256(problem)})
    modes = mode_sequence(expansion, solution.phases)
    return solution.model_copy(update={"reproduce": digest, "mode_sequence": modes})


def _solved(
    problem: Problem,
    guess: Callable[[Model], list[Trajectory]],
    run: Run,
    publish: Callable[[Sequence[SolvedMesh]], None],
) -> list[SolvedMesh]:
    """All meshes, as of the phases and modes of the problem."""
    with run.stage("build"):
        model, setting = prepare(problem, guess)
    switches = problem.refinement is not None and problem.refinement.switches
    meshes = solve_switched if switches else solve_meshes
    return meshes(problem, model, setting, run, publish, warm=False)


def _certificate(problem: Problem, solved: Sequence[SolvedMesh], run: Run) -> Certificate:
    chosen = choose(problem, solved)
    checks = JUDGED if run.stopped() else CHECKS
    until = max(run.deadline, time.monotonic() + GRACE)
    objective = finite(chosen.objective)
    return certify(problem, chosen.phases, objective, checks, chosen.statics, until)
