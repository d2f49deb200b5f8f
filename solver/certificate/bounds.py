"""Bounds along a phase, sampled densely between the nodes, and bounds on static parameters."""

import numpy as np

from schemas import resolve
from schemas.expressions import Name, stem
from schemas.results import Check
from solver.certificate.case import AnyPhase, Case
from solver.certificate.findings import Finding, judge, violation, worst_sample


def state_bounds(case: Case) -> Check | None:
    """How far states and their derivatives leave their bounds, relative to one plus the limit."""
    findings = [finding for phase in case.phases for finding in _outside(phase, of_controls=False)]
    return judge("state bounds", findings, case.constraint_tolerance)


def control_overshoot(case: Case) -> Check | None:
    """The same for controls and their derivatives.

    A row of its own: a polynomial that keeps its bounds at every node may still pass them in
    between, and a smaller objective is then bought with a control that is not allowed.
    """
    findings = [finding for phase in case.phases for finding in _outside(phase, of_controls=True)]
    return judge("control overshoot", findings, case.constraint_tolerance)


def static_bounds(case: Case) -> Check | None:
    """How far static parameters leave their bounds; one without a value is out of any."""
    findings = [
        Finding(
            float(violation(np.array(value), resolve.interval(spec.bounds, {}))), f"static {name}"
        )
        for (name, spec), value in zip(
            case.problem.static.items(), case.statics.values(), strict=True
        )
    ]
    return judge("static bounds", findings, case.constraint_tolerance)


def _outside(phase: AnyPhase, *, of_controls: bool) -> list[Finding]:
    """A finding for each bound, be it on one of the controls or not."""
    controls = phase.spec.system.control_names
    names = [name for name in phase.spec.bounds if (stem(name)[1] in controls) == of_controls]
    return [
        worst_sample(
            phase.name,
            [name],
            phase.samples.t,
            violation(values, resolve.interval(phase.spec.bounds[name], phase.parameters))[None],
        )
        for name, values in zip(names, phase.sampled([Name(n) for n in names]), strict=True)
    ]
