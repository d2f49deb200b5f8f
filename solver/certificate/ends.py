"""Values at the ends of the phases, and when these are."""

from collections.abc import Mapping

import numpy as np

from schemas import resolve
from schemas.results import Check
from schemas.values import Bound
from solver.certificate.case import AnyPhase, Case
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
    """How far the phases' times and durations lie off theirs.

    A later phase starts when the one before it ends. None can end before it starts: curves whose
    breaks decrease are not read.
    """
    previous = (None, *case.phases[:-1])
    findings = [
        finding
        for phase, before in zip(case.phases, previous, strict=True)
        for finding in (_starts(phase, before), *_ends(phase))
    ]
    return judge("time", findings, case.constraint_tolerance)


def _starts(phase: AnyPhase, before: AnyPhase | None) -> Finding:
    if before is None:
        return _beyond(phase, "initial.t", phase.ends["initial.t"], phase.spec.time.start)
    start, end = phase.ends["initial.t"], before.ends["final.t"]
    where = f"phase {phase.name}, initial.t is not phase {before.name}, final.t"
    return Finding(abs(start - end) / (1 + abs(end)), where)


def _ends(phase: AnyPhase) -> list[Finding]:
    spec = phase.spec.time
    pairs = (
        ("final.t", phase.ends["final.t"], spec.final),
        ("duration", phase.duration, spec.duration),
    )
    return [_beyond(phase, what, value, bound) for what, value, bound in pairs if bound]


def _off(phase: AnyPhase, side: str, bounds: Mapping[str, Bound]) -> list[Finding]:
    return [
        _beyond(phase, f"{side}.{name}", phase.ends[f"{side}.{name}"], bound)
        for name, bound in bounds.items()
    ]


def _beyond(phase: AnyPhase, what: str, value: float, bound: Bound) -> Finding:
    size = violation(np.array(value), resolve.interval(bound, phase.parameters))
    return Finding(float(size), f"phase {phase.name}, {what}")
