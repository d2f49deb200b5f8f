"""What a failed solve tells: the constraints that cannot be met, or where numbers end."""

from collections.abc import Callable
from dataclasses import dataclass

from schemas.problem import SolverSettings
from solver.backends import NlpStatus, Outcome, Watch, make_backend
from solver.nlp.invalid import find_invalid
from solver.nlp.program import Program
from solver.nlp.residuals import RowResidual
from solver.nlp.scaling import Scaling
from solver.nlp.task import NlpTask
from solver.solving.unmet import unmet

_ELSEWHERE = (
    "From elsewhere all constraints can be met: try another guess, 'multistart', or "
    "solver.portfolio."
)


@dataclass(frozen=True, slots=True)
class Findings:
    """Residuals that count more than those at the last iterate, and advice."""

    residuals: tuple[RowResidual, ...] = ()
    advice: tuple[str, ...] = ()


def find(
    outcome: Outcome,
    settings: SolverSettings,
    program: Program,
    scaling: Scaling,
    task: NlpTask,
    watch: Callable[[], Watch],
) -> Findings:
    """Look into an outcome that is infeasible or met no number; nothing for any other."""
    if outcome.status is NlpStatus.INFEASIBLE:
        return _infeasible(settings, program, scaling, task, watch)
    if outcome.status is NlpStatus.INVALID_NUMBER:
        return _invalid(outcome, program, task)
    return Findings()


def _infeasible(
    settings: SolverSettings,
    program: Program,
    scaling: Scaling,
    task: NlpTask,
    watch: Callable[[], Watch],
) -> Findings:
    # The backend of the problem may not take the relaxed program; IPOPT takes every one.
    backend = make_backend("ipopt")
    found = unmet(backend, settings, watch(), program, scaling, task)
    if found is None:
        return Findings()
    return Findings(tuple(found), () if found else (_ELSEWHERE,))


def _invalid(outcome: Outcome, program: Program, task: NlpTask) -> Findings:
    rows = find_invalid(program, task, outcome.point.z)
    nan = float("nan")
    residuals = [RowResidual(row.name, row.phase, row.fraction, nan, float("inf")) for row in rows]
    names = ", ".join(f"'{row.name}'" for row in rows[:5])
    advice = (f"Near the last iterate these have no finite value or slope: {names}.",)
    return Findings(tuple(residuals), advice if rows else ())
