"""Solving with switches: the phases split where a solution switches, solved, looked at again."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from schemas.events import StageStarted
from schemas.problem import Problem
from solver.meshes.sequence import Publish, solve_meshes
from solver.meshes.settled import settled
from solver.meshes.solve_mesh import SolvedMesh
from solver.model import Model
from solver.prepare import prepare
from solver.run import Run
from solver.switches.join import by_phase, guesses, join, whole
from solver.switches.propose import ROUNDS, propose
from solver.switches.split import Cut, Plan, split
from solver.transcribe import Setting

_WORSE = 10.0
"""In tolerances of the mesh: a later split whose objective is so much higher has gone astray."""


def solve_switched(
    problem: Problem, model: Model, setting: Setting, run: Run, publish: Publish, *, warm: bool
) -> list[SolvedMesh]:
    """Solve as ``solve_meshes`` does until a solution shows switches, then the parts between them.

    What the parts show is split again, a few times. Where the first split comes to nothing, the
    meshes go on without; where a later one does, the one before it counts.

    Returns
    -------
    All meshes that count, of the problem's own phases: parts are joined.
    """

    def cuts_of(mesh: SolvedMesh, plan: Plan | None = None) -> list[Cut] | None:
        if run.stopped() or not mesh.optimal:
            return None
        return propose(problem, mesh.phases, mesh.statics, plan)

    solved = solve_meshes(
        problem, model, setting, run, publish, warm=warm, enough=lambda mesh: bool(cuts_of(mesh))
    )
    whole_mesh, last, plan = solved[-1], solved[-1], None
    for _ in range(ROUNDS):
        cuts = cuts_of(last, plan)
        if cuts is None:
            return solved
        attempt, parts = _solve_parts(problem, cuts, plan, last, run, publish, solved)
        failed = not settled(problem, parts[-1])
        if failed or (plan is not None and _worse(problem, parts[-1], last)):
            break
        solved = [*solved, *(joined(attempt, mesh) for mesh in parts)]
        plan, last = attempt, parts[-1]
    if plan is None and not run.stopped():
        again = replace(
            whole_mesh.setting,
            guesses=whole_mesh.trajectories,
            statics=list(whole_mesh.statics.values()),
        )
        run.on_event(StageStarted(stage="build", note="without splits again"))
        solved += solve_meshes(problem, model, again, run, publish, warm=True)
    return solved


def _solve_parts(
    problem: Problem,
    cuts: Sequence[Cut],
    before: Plan | None,
    last: SolvedMesh,
    run: Run,
    publish: Publish,
    solved: Sequence[SolvedMesh],
) -> tuple[Plan, list[SolvedMesh]]:
    """The parts between all cuts, from what was ``solved`` ``last``."""
    count = sum(len(cut.times) for cut in cuts)
    run.on_event(StageStarted(stage="build", note=f"split at {count} switch{'es' * (count != 1)}"))
    with run.stage("build"):
        parted, plan = split(problem, cuts)
        model, setting = prepare(parted)
        trajectories = last.trajectories if before is None else whole(before, last.trajectories)
        setting = replace(
            setting,
            guesses=guesses(plan, trajectories),
            statics=list(last.statics.values()),
        )

    def show(so_far: Sequence[SolvedMesh]) -> None:
        publish([*solved, *(joined(plan, mesh) for mesh in so_far)])

    return plan, solve_meshes(parted, model, setting, run, show, warm=True)


def _worse(problem: Problem, mesh: SolvedMesh, before: SolvedMesh) -> bool:
    tolerance = problem.refinement.tolerance if problem.refinement else 0.0
    rise = mesh.objective - before.objective
    return rise > _WORSE * tolerance * (1 + abs(before.objective))


def joined(plan: Plan, mesh: SolvedMesh) -> SolvedMesh:
    """A mesh of the parts as one of the phases that the user posted."""
    owners = np.repeat(np.arange(len(plan.counts)), plan.counts)
    parts = by_phase(plan, mesh.phases)
    return replace(
        mesh,
        phases=join(plan, mesh.phases),
        trajectories=whole(plan, mesh.trajectories),
        errors=[np.concatenate(own) for own in by_phase(plan, mesh.errors)],
        integral_errors=[np.concatenate(own) for own in by_phase(plan, mesh.integral_errors)],
        excess=[np.concatenate(own) for own in by_phase(plan, mesh.excess)],
        residuals=[
            row if row.phase is None else replace(row, phase=int(owners[row.phase]))
            for row in mesh.residuals
        ],
        switches=[part.knots[-1] for own in parts for part in own[:-1]],
    )
