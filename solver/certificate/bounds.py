"""Bounds on states and controls, sampled densely between the nodes."""

from collections.abc import Sequence

import numpy as np

from schemas import resolve
from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, violation, worst_sample
from solver.numeric import Array


def state_bounds(case: Case) -> Check | None:
    """How far the states leave their bounds, relative to one plus the limit's size."""
    findings = [
        finding
        for phase in case.phases
        for finding in _outside(phase, phase.spec.system.states, phase.samples.x)
    ]
    return judge("state bounds", findings, case.constraint_tolerance)


def control_overshoot(case: Case) -> Check | None:
    """The same for the controls.

    A row of its own: a polynomial that keeps its bounds at every node may still pass them in
    between, and a smaller objective is then bought with a control that is not allowed.
    """
    findings = [
        finding
        for phase in case.phases
        for finding in _outside(phase, phase.spec.system.controls, phase.samples.u)
    ]
    return judge("control overshoot", findings, case.constraint_tolerance)


def _outside(phase: PhaseCase, names: Sequence[str], values: Array) -> list[Finding]:
    """A finding for each of the names that has a bound; ``values`` (names, samples)."""
    return [
        worst_sample(
            phase.name,
            [name],
            phase.samples.t,
            violation(
                values[np.newaxis, row],
                resolve.interval(phase.spec.bounds[name], phase.constants),
            ),
        )
        for row, name in enumerate(names)
        if name in phase.spec.bounds
    ]
