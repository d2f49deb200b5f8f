"""The certificate: every check in turn, and the verdict."""

from collections.abc import Callable, Sequence

import numpy as np

from schemas.problem import Problem
from schemas.results import Certificate, Check, PhaseResult
from solver.certificate.bounds import control_overshoot, state_bounds
from solver.certificate.case import Case
from solver.certificate.constraints import boundary_constraints, path_constraints
from solver.certificate.continuity import continuity
from solver.certificate.dynamics import interval_defect
from solver.certificate.ends import end_values, time
from solver.certificate.objective import objective as recomputed
from solver.certificate.rollout import rollout
from solver.numeric import MalformedCurves

CHECKS: tuple[Callable[[Case], Check | None], ...] = (
    interval_defect,
    continuity,
    end_values,
    time,
    state_bounds,
    control_overshoot,
    path_constraints,
    boundary_constraints,
    recomputed,
    rollout,
)
"""In the order of the certificate's rows. A check answers None where it does not apply."""


@np.errstate(all="ignore")  # numbers that do not exist are findings, not warnings
def certify(
    problem: Problem, phases: Sequence[PhaseResult], objective: float | None
) -> Certificate:
    """Judge published curves against the problem's own text, by other means than the solver's.

    Parameters
    ----------
    problem
        As it was posted and checked.
    phases
        The result of every phase. Only names and curves are read.
    objective
        The published value of the objective.

    Returns
    -------
    ``certified`` where every judged check passes. Curves that cannot be read fail the one check
    ``curves``, whose ``where`` says why.
    """
    try:
        case = Case.open(problem, phases, objective)
    except MalformedCurves as reason:
        return Certificate(verdict="not_certified", checks=[_unreadable(str(reason))])
    checks = [row for row in (check(case) for check in CHECKS) if row is not None]
    passed = all(check.passed for check in checks if check.judged)
    return Certificate(verdict="certified" if passed else "not_certified", checks=checks)


def _unreadable(reason: str) -> Check:
    return Check(
        name="curves",
        value=None,
        tolerance=None,
        unit="",
        passed=False,
        judged=True,
        where=reason,
    )
