"""SolvedMeshs and certificate -> the published solution: status, message, advice, history."""

import platform
from collections.abc import Iterator, Sequence
from functools import cache
from importlib.metadata import version

import numpy as np

from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import (
    Certificate,
    Complementarity,
    MeshIteration,
    MeshRefinement,
    PhaseResult,
    Reproduce,
    Residual,
    Solution,
    SolutionStatus,
    SolverReport,
    finite,
)
from solver.backends import NlpStatus
from solver.certificate.losses import SHARE
from solver.meshes import SolvedMesh, settled
from solver.nlp.residuals import RowResidual
from solver.run import Run
from solver.simulation.frames import with_frames
from solver.solution.choose import choose
from solver.solution.words import advice, message, warnings

_STATUS = {
    NlpStatus.ACCEPTABLE: SolutionStatus.ACCEPTABLE,
    NlpStatus.INFEASIBLE: SolutionStatus.LOCALLY_INFEASIBLE,
    NlpStatus.DIVERGED: SolutionStatus.DIVERGED,
    NlpStatus.UNBOUNDED: SolutionStatus.UNBOUNDED,
    NlpStatus.ITERATION_LIMIT: SolutionStatus.ITERATION_LIMIT,
    NlpStatus.TIME_LIMIT: SolutionStatus.TIME_LIMIT,
    NlpStatus.STOPPED: SolutionStatus.CANCELLED,
    NlpStatus.INVALID_NUMBER: SolutionStatus.INVALID_NUMBER,
}
"""What becomes of an NLP that did not end at an optimum."""


def conclude(
    problem: Problem, solved: Sequence[SolvedMesh], certificate: Certificate, run: Run
) -> Solution:
    """The solution of a finished run."""
    chosen = choose(problem, solved)
    status = _status(problem, solved, certificate)
    return _solution(problem, solved, chosen, certificate, status, run)


def snapshot(problem: Problem, solved: Sequence[SolvedMesh], run: Run) -> Solution:
    """An uncertified solution of a run that goes on; what is served if it is killed."""
    unchecked = Certificate(verdict="not_checked", checks=[])
    chosen = choose(problem, solved)
    return _solution(problem, solved, chosen, unchecked, SolutionStatus.CANCELLED, run)


_ENDED = (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT, NlpStatus.ACCEPTABLE)


def _status(
    problem: Problem, solved: Sequence[SolvedMesh], certificate: Certificate
) -> SolutionStatus:
    """How the mathematics ended: optimal, meshed and certified is ``converged``.

    Where a finer mesh finds nothing, there is the optimum before it: its mesh is the limit.
    """
    last, chosen = solved[-1], choose(problem, solved)
    if chosen.pairs is not None and _stalled(chosen):
        return SolutionStatus.COMPLEMENTARITY_STALLED
    if not settled(problem, chosen):
        if last.optimal:
            return SolutionStatus.MESH_LIMIT
        lost = len(solved) > 1 and last.outcome.status not in _ENDED
        return SolutionStatus.MESH_LIMIT if lost else _STATUS[last.outcome.status]
    if last is not chosen and last.outcome.status in _ENDED[:2]:
        return _STATUS[last.outcome.status]
    if certificate.verdict != "certified":
        return SolutionStatus.CERTIFICATE_FAILED
    return SolutionStatus.CONVERGED


def _stalled(chosen: SolvedMesh) -> bool:
    """Whether contacts were left relaxed, and nothing but that ended the solve."""
    pairs, status = chosen.pairs, chosen.outcome.status
    if pairs is None or status in _ENDED[:2]:
        return False
    return pairs.stalled or (status is NlpStatus.ACCEPTABLE and not pairs.polished)


def _solution(
    problem: Problem,
    solved: Sequence[SolvedMesh],
    chosen: SolvedMesh,
    certificate: Certificate,
    status: SolutionStatus,
    run: Run,
) -> Solution:
    residuals = [_residual(residual, chosen.phases) for residual in chosen.residuals]
    return Solution(
        name=problem.name,
        status=status,
        objective=finite(chosen.objective),
        message=message(problem, status, solved, certificate),
        advice=[
            *chosen.advice,
            *advice(problem, status, chosen.phases, residuals, certificate),
        ],
        warnings=[
            *warnings(problem, chosen.redundancy),
            *_lossy(chosen),
            *solved[0].warnings,
        ],
        static={name: finite(chosen.statics[name]) for name in problem.static},
        phases=_framed(problem, chosen),
        complementarity=_complementarity(chosen, certificate),
        mesh_refinement=_history(problem, solved),
        certificate=certificate,
        solver=SolverReport(
            backend=problem.solver.backend,
            iterations=chosen.outcome.iterations,
            status=chosen.outcome.raw,
            residuals=residuals,
            strategy=chosen.strategy,
            attempts=list(chosen.attempts),
            seconds=chosen.outcome.seconds,
            variables=chosen.variables,
            constraints=chosen.rows,
        ),
        timing=run.timing(),
        reproduce=Reproduce(spec_sha256=spec_sha256(problem), versions=dict(_versions())),
    )


def _lossy(chosen: SolvedMesh) -> Iterator[str]:
    """That the objective counts on what the steps themselves lose."""
    if chosen.stepped and chosen.max_error > SHARE:
        yield (
            f"Outside of impacts the steps lose {chosen.max_error:.0%} of the actuators' work by "
            "themselves: the objective is not yet physical. Take more, or polish."
        )


def _complementarity(chosen: SolvedMesh, certificate: Certificate) -> Complementarity | None:
    """The homotopy of the published mesh; what its contacts miss is the certificate's own value."""
    if (pairs := chosen.pairs) is None:
        return None
    checked = {check.name: check.value for check in certificate.checks}
    return Complementarity(
        form=pairs.form,
        passes=list(pairs.passes),
        polished=pairs.polished,
        residual=checked.get("complementarity"),
        stationarity=pairs.stationarity,
        pinned=pairs.pinned,
        dissipation=finite(chosen.max_error),
    )


def _framed(problem: Problem, chosen: SolvedMesh) -> list[PhaseResult]:
    """The phases with the frames of their motions, for drawing."""
    systems = {phase.name: phase.system for phase in problem.phases}
    return [
        with_frames(phase, systems[phase.name], chosen.statics) if phase.name in systems else phase
        for phase in chosen.phases
    ]


def _history(problem: Problem, solved: Sequence[SolvedMesh]) -> MeshRefinement:
    settings = problem.refinement
    return MeshRefinement(
        tolerance=settings.tolerance if settings else None,
        converged=settled(problem, choose(problem, solved)),
        iterations=[_mesh(mesh) for mesh in solved],
    )


def _mesh(mesh: SolvedMesh) -> MeshIteration:
    spans = [
        (start, end)
        for phase in mesh.phases
        for start, end in zip(phase.knots[:-1], phase.knots[1:], strict=True)
    ]
    return MeshIteration(
        segments=len(spans),
        max_error=finite(mesh.max_error),
        errors=[finite(error) for error in np.concatenate(mesh.errors)],
        spans=spans,
        objective=finite(mesh.objective),
        nlp_iterations=mesh.outcome.iterations,
        seconds=mesh.seconds,
        status=mesh.outcome.status,
        degrees=[
            int(n) for one in mesh.setting.meshes if one.degrees is not None for n in one.degrees
        ],
        switches=list(mesh.switches),
    )


def _residual(residual: RowResidual, phases: Sequence[PhaseResult]) -> Residual:
    """With the phase's name and the time in seconds."""
    phase = None if residual.phase is None else phases[residual.phase]
    time = None
    if phase is not None and np.isfinite(residual.fraction):
        time = phase.knots[0] + residual.fraction * (phase.knots[-1] - phase.knots[0])
    return Residual(
        name=residual.name.replace("#", "."),  # a slack is what it stands for
        phase=phase.name if phase else None,
        time=time,
        value=finite(residual.value),
    )


@cache
def _versions() -> dict[str, str]:
    packages = ("footfall-server", "casadi", "numpy", "scipy")
    return {"python": platform.python_version()} | {name: version(name) for name in packages}
