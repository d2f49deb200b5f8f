"""SolvedMeshs and certificate -> the published solution: status, message, advice, history."""

import platform
from collections.abc import Sequence
from importlib.metadata import version

import numpy as np

from schemas.problem import Problem
from schemas.reading import spec_sha256
from schemas.results import (
    Certificate,
    MeshIteration,
    MeshRefinement,
    PhaseResult,
    Reproduce,
    Residual,
    Solution,
    SolutionStatus,
    SolverReport,
)
from solver.backends import NlpStatus
from solver.nlp.residuals import RowResidual
from solver.run import Run
from solver.solution.words import advice, message, warnings
from solver.solve_mesh import SolvedMesh
from solver.transcribe import finite

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


def choose(solved: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh to publish: the last, or the one before where the last came to nothing.

    Only an infeasible last mesh is published as it is: its residuals say what cannot be met.
    """
    last = solved[-1]
    told = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE, NlpStatus.INFEASIBLE)
    return last if last.outcome.status in told or len(solved) == 1 else solved[-2]


def conclude(
    problem: Problem, solved: Sequence[SolvedMesh], certificate: Certificate, run: Run
) -> Solution:
    """The solution of a finished run."""
    chosen = choose(solved)
    status = _status(problem, solved[-1], certificate)
    return _solution(problem, solved, chosen, certificate, status, run)


def snapshot(problem: Problem, solved: Sequence[SolvedMesh], run: Run) -> Solution:
    """An uncertified solution of a run that goes on; what is served if it is killed."""
    unchecked = Certificate(verdict="not_checked", checks=[])
    chosen = choose(solved)
    return _solution(problem, solved, chosen, unchecked, SolutionStatus.CANCELLED, run)


def _status(problem: Problem, last: SolvedMesh, certificate: Certificate) -> SolutionStatus:
    """How the mathematics ended: optimal, meshed and certified is ``converged``."""
    if not last.optimal:
        return _STATUS[last.outcome.status]
    if problem.refinement is not None and not last.max_error <= problem.refinement.tolerance:
        return SolutionStatus.MESH_LIMIT
    if certificate.verdict != "certified":
        return SolutionStatus.CERTIFICATE_FAILED
    return SolutionStatus.CONVERGED


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
        message=message(status, solved, certificate),
        advice=advice(status, residuals, certificate),
        warnings=warnings(problem, chosen.redundancy),
        phases=chosen.phases,
        mesh_refinement=_history(problem, solved),
        certificate=certificate,
        solver=SolverReport(
            backend=problem.solver.backend,
            iterations=chosen.outcome.iterations,
            status=chosen.outcome.raw,
            residuals=residuals,
            seconds=chosen.outcome.seconds,
            variables=chosen.variables,
            constraints=chosen.rows,
        ),
        timing=run.timing(),
        reproduce=Reproduce(spec_sha256=spec_sha256(problem), versions=_versions()),
    )


def _history(problem: Problem, solved: Sequence[SolvedMesh]) -> MeshRefinement:
    settings, last = problem.refinement, solved[-1]
    tolerance = settings.tolerance if settings else None
    return MeshRefinement(
        tolerance=tolerance,
        converged=last.optimal and (tolerance is None or last.max_error <= tolerance),
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
    )


def _residual(residual: RowResidual, phases: Sequence[PhaseResult]) -> Residual:
    """With the phase's name and the time in seconds."""
    phase = None if residual.phase is None else phases[residual.phase]
    time = None
    if phase is not None and np.isfinite(residual.fraction):
        time = phase.knots[0] + residual.fraction * (phase.knots[-1] - phase.knots[0])
    return Residual(
        name=residual.name, phase=phase.name if phase else None, time=time, value=residual.value
    )


def _versions() -> dict[str, str]:
    packages = ("footfall-server", "casadi", "numpy", "scipy")
    return {"python": platform.python_version()} | {name: version(name) for name in packages}
