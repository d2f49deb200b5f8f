"""Path and boundary constraints, and linkages between phases."""

from collections.abc import Mapping

import numpy as np

from schemas import resolve
from schemas.phases import Constraint
from schemas.results import Check
from solver.certificate.case import AnyPhase, Case
from solver.certificate.findings import Finding, judge, violation, worst_sample
from solver.certificate.unsettled import unsettled
from solver.numeric import evaluate


def path_constraints(case: Case) -> Check | None:
    """How far path constraints are violated at the samples, relative to one plus the limit."""
    findings = [finding for phase in case.phases for finding in _along_path(phase)]
    return judge("path constraints", findings, case.constraint_tolerance)


def boundary_constraints(case: Case) -> Check | None:
    """How far boundary constraints are violated; integrals in them are computed anew."""
    findings = [
        finding
        for phase in case.phases
        for row in phase.spec.boundary
        for finding in (
            _once(row, phase.scope, phase.parameters, f"phase {phase.name}, {row.name}"),
            *unsettled(case, row.expression.tree, case.constraint_tolerance, phase),
        )
    ]
    return judge("boundary constraints", findings, case.constraint_tolerance)


def linkages(case: Case) -> Check | None:
    """How far the constraints over the ends of several phases are violated."""
    findings = [
        finding
        for row in case.problem.linkages
        for finding in (
            _once(row, case.scope, {}, f"linkage {row.name}"),
            *unsettled(case, row.expression.tree, case.constraint_tolerance),
        )
    ]
    return judge("linkages", findings, case.constraint_tolerance)


def _along_path(phase: AnyPhase) -> list[Finding]:
    rows = phase.spec.path
    if not rows:
        return []
    values = phase.sampled([row.expression.tree for row in rows])
    sizes = [
        violation(value, resolve.interval(row, phase.parameters))
        for row, value in zip(rows, values, strict=True)
    ]
    names = [row.name for row in rows]
    return [worst_sample(phase.name, names, phase.samples.t, np.array(sizes))]


def _once(
    row: Constraint, scope: Mapping[str, float], constants: Mapping[str, float], where: str
) -> Finding:
    """A constraint over numbers of the ends; its limits may use ``constants``."""
    value = np.array(evaluate(row.expression.tree, scope))
    return Finding(float(violation(value, resolve.interval(row, constants))), where)
