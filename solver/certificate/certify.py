"""The certificate: every check in turn, and the verdict."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from schemas.problem import Problem
from schemas.results import Certificate, Check, PhaseResult
from solver.certificate import audit, losses, momentum, replay
from solver.certificate.bounds import control_overshoot, state_bounds, static_bounds
from solver.certificate.case import Case
from solver.certificate.clock import Clock, OutOfTime
from solver.certificate.constraints import boundary_constraints, linkages, path_constraints
from solver.certificate.continuity import continuity
from solver.certificate.dynamics import interval_defect
from solver.certificate.ends import end_values, time
from solver.certificate.held import contacts_and_loops
from solver.certificate.objective import objective as recomputed
from solver.certificate.rollout import rollout
from solver.numeric import MalformedCurves

AUDIT: tuple[Callable[[Case], Check | None], ...] = (
    audit.step_velocities,
    audit.normal_work,
    audit.friction_work,
    audit.limit_work,
    audit.energy_balance,
    momentum.momentum,
    momentum.equations_of_motion,
    audit.complementarity,
    audit.penetration,
    audit.tunnelling,
    audit.slips_between,
    audit.closed_loops,
)
"""Of phases of contact-implicit steps, on which no curve could be integrated."""

REPORTED: tuple[Callable[[Case], Check | None], ...] = (
    losses.dissipation,
    momentum.forward_dynamics,
    replay.early_replay,
    replay.whole_replay,
    rollout,
)
"""Those that have no say in the verdict. The last ones take the most time."""

JUDGED: tuple[Callable[[Case], Check | None], ...] = (
    interval_defect,
    continuity,
    end_values,
    time,
    state_bounds,
    control_overshoot,
    path_constraints,
    contacts_and_loops,
    boundary_constraints,
    linkages,
    static_bounds,
    recomputed,
    *AUDIT,
)
"""In the order of the certificate's rows. A check answers None where it does not apply."""

CHECKS = (*JUDGED, *REPORTED)
"""All of them."""


@np.errstate(all="ignore")  # numbers that do not exist are findings, not warnings
def certify(
    problem: Problem,
    phases: Sequence[PhaseResult],
    objective: float | None,
    checks: Sequence[Callable[[Case], Check | None]] = CHECKS,
    statics: Mapping[str, float | None] | None = None,
    until: float = math.inf,
) -> Certificate:
    """Judge published curves against the problem's own text, by other means than the solver's.

    Parameters
    ----------
    problem
        As it was posted and checked; smoothed where that was asked for.
    phases
        The result of every phase. Only names and curves are read.
    objective
        The published value of the objective.
    checks
        ``CHECKS``, or ``JUDGED`` where there is no time for the rest.
    statics
        The published values of the static parameters.
    until
        When to end, in seconds of ``time.monotonic``; a check that has not ended then fails.

    Returns
    -------
    ``certified`` where every judged check passes. Curves that cannot be read fail the one check
    ``curves``, whose ``where`` says why.
    """
    try:
        case = Case.open(problem, phases, objective, statics or {}, Clock(until))
    except MalformedCurves as reason:
        return Certificate(verdict="not_certified", checks=[_failed("curves", str(reason))])
    rows = [row for row in (_row(check, case) for check in checks) if row is not None]
    passed = all(row.passed for row in rows if row.judged)
    return Certificate(verdict="certified" if passed else "not_certified", checks=rows)


def _row(check: Callable[[Case], Check | None], case: Case) -> Check | None:
    try:
        return check(case)
    except OutOfTime:
        name = check.__name__.replace("_", " ")
        return _failed(name, "the time for the certificate is over", judged=check in JUDGED)


def _failed(name: str, reason: str, *, judged: bool = True) -> Check:
    return Check(
        name=name,
        value=None,
        tolerance=None,
        unit="",
        passed=False,
        judged=judged,
        where=reason,
    )
