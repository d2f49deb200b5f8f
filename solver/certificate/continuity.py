"""Do the states go on where they left off? Dynamics alone would not see a jump at a break."""

import numpy as np

from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, worst_sample


def continuity(case: Case) -> Check | None:
    """The largest jump of a state between segments, relative to one plus its largest size."""
    findings = [_jump(phase) for phase in case.curved if phase.curves.segments > 1]
    return judge("continuity", findings, case.tolerance)


def _jump(phase: PhaseCase) -> Finding:
    ends = phase.curves.states.grid(np.array([-1.0, 1.0]))
    sizes = np.abs(ends[:, 1:, 0] - ends[:, :-1, 1]) / phase.scale[:, None]
    return worst_sample(phase.name, phase.form.states, phase.curves.breaks[1:-1], sizes)
