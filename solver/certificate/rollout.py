"""Where does the motion go if only the controls are followed? Reported, never judged."""

import math
from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, worst_sample
from solver.certificate.integration import Integrator, Unfinished
from solver.numeric import Array

TOLERANCE = 1e-10


def rollout(case: Case) -> Check | None:
    """The largest distance from the curves of an open-loop motion over each whole phase.

    Errors grow in it as the system lets them: an unstable one amplifies 1e-8 to anything, and
    that is no fault of the curves. Hence no tolerance. Compared at the breaks. A closed form has
    nothing to integrate.
    """
    findings = [_deviation(phase) for phase in case.curved if not phase.form.flow]
    return judge("open-loop rollout", findings, tolerance=None, judged=False)


def _deviation(phase: PhaseCase) -> Finding:
    curves = phase.curves
    curve, integrator = curves.knots(), Integrator(TOLERANCE)
    motion = curve.copy()
    for k in range(curves.segments):
        # From break to break: a step over the kink of a control there would cost accuracy.
        try:
            motion[:, k + 1] = integrator.advance(_rates(phase, k), -1.0, motion[:, k], 1.0)
        except Unfinished as reason:
            time = curves.time(np.array(k), reason.at)
            return Finding(math.nan, f"phase {phase.name}, t = {time:.6g} s: {reason}")
    sizes = np.abs(motion - curve) / phase.scale[:, None]
    return worst_sample(phase.name, phase.form.states, curves.breaks, sizes)


def _rates(phase: PhaseCase, segment: int) -> Callable[[float, Array], Array]:
    """The rates of the states over s in [-1, 1], under the control of one segment."""
    start, end = phase.curves.breaks[segment : segment + 2].tolist()
    half = (end - start) / 2
    control = phase.curves.controls.coefficients[:, segment].T

    def rates(s: float, x: Array) -> Array:
        phase.clock.look()
        u = np.asarray(chebyshev.chebval(s, control, tensor=False))
        return np.asarray(phase.dynamics(start + half * (s + 1), x, u) * half)

    return rates
