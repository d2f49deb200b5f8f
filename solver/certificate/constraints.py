"""Path and boundary constraints."""

import numpy as np

from schemas import resolve
from schemas.phases import Constraint
from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, violation, worst_sample
from solver.numeric import along, evaluate


def path_constraints(case: Case) -> Check | None:
    """How far path constraints are violated at the samples, relative to one plus the limit."""
    findings = [finding for phase in case.phases for finding in _along_path(phase)]
    return judge("path constraints", findings, case.constraint_tolerance)


def boundary_constraints(case: Case) -> Check | None:
    """How far boundary constraints are violated; integrals in them are computed anew."""
    findings = [
        _at_ends(phase, constraint) for phase in case.phases for constraint in phase.spec.boundary
    ]
    return judge("boundary constraints", findings, case.constraint_tolerance)


def _along_path(phase: PhaseCase) -> list[Finding]:
    at, rows = phase.samples, phase.spec.path
    if not rows:
        return []
    values = along(phase.spec.system, [row.expression.tree for row in rows])(at.t, at.x, at.u)
    sizes = [
        violation(value, resolve.interval(row, phase.constants))
        for row, value in zip(rows, values, strict=True)
    ]
    return [worst_sample(phase.name, [row.name for row in rows], at.t, np.array(sizes))]


def _at_ends(phase: PhaseCase, constraint: Constraint) -> Finding:
    value = np.array(evaluate(constraint.expression.tree, phase.scope))
    size = violation(value, resolve.interval(constraint, phase.constants))
    return Finding(float(size), f"phase {phase.name}, {constraint.name}")
