"""Values at the ends of the phases, and when these are."""

from collections.abc import Mapping

import numpy as np

from schemas import resolve
from schemas.results import Check
from schemas.values import Bound
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, violation


def end_values(case: Case) -> Check | None:
    """How far initial and final values lie off what was asked, relative to one plus its size."""
    findings = [
        finding
        for phase in case.phases
        for side, bounds in (("initial", phase.spec.initial), ("final", phase.spec.final))
        for finding in _off(phase, side, bounds)
    ]
    return judge("end values", findings, case.constraint_tolerance)


def time(case: Case) -> Check | None:
    """How far the phases' times lie off theirs; a phase must not end before it starts."""
    findings = [
        finding
        for phase in case.phases
        for side, bound in (("initial", phase.spec.time.start), ("final", phase.spec.time.final))
        for finding in _off(phase, side, {"t": bound})
    ]
    return judge("time", findings, case.constraint_tolerance)


def _off(phase: PhaseCase, side: str, bounds: Mapping[str, Bound]) -> list[Finding]:
    return [
        Finding(
            float(
                violation(
                    np.array(phase.ends[f"{side}.{name}"]),
                    resolve.interval(bound, phase.constants),
                )
            ),
            f"phase {phase.name}, {side}.{name}",
        )
        for name, bound in bounds.items()
    ]
