"""Do the curves obey the dynamics? Every segment is integrated anew from its own start."""

import itertools
import math

import numpy as np

from schemas.results import Check
from solver.certificate.case import Case, PhaseCase
from solver.certificate.findings import Finding, judge, worst_sample
from solver.certificate.integration import EVALUATIONS, Integrator, Unfinished
from solver.numeric import Array, flow

PLACES = np.linspace(-1.0, 1.0, 5)
"""Where in a segment the two are compared: the quarters and the end."""

WORK = 20_000_000
"""Rates of single states in one phase after which a stiff one is given up: a few seconds."""


def interval_defect(case: Case) -> Check | None:
    """The largest distance between the curves and the integrated motion.

    Each segment starts at the curve's own state and follows the curve's own control, with the
    limits from inside the segment at its ends. Distances are relative to one plus the state's
    largest size in the phase. A closed form needs no integration: its curves are compared with its
    formula from their own start.
    """
    findings = [
        _distance(phase) if phase.form.flow else _defect(phase, case.tolerance)
        for phase in case.curved
    ]
    return judge("interval defect", findings, case.tolerance)


def _defect(phase: PhaseCase, tolerance: float) -> Finding:
    curve = phase.curves.states.grid(PLACES)
    try:
        motion = _integrated(phase, curve[:, :, 0], tolerance)
    except Unfinished as reason:
        return Finding(math.nan, f"{_culprit(phase, reason)}: {reason}")
    sizes = np.abs(motion - curve) / phase.scale[:, None, None]
    times = phase.curves.time(np.arange(curve.shape[1])[:, None], PLACES)
    states = phase.form.states
    return worst_sample(phase.name, states, times.ravel(), sizes.reshape(len(states), -1))


def _distance(phase: PhaseCase) -> Finding:
    """Of a closed form's curves from its formula."""
    at = phase.samples
    formula = flow(phase.form, phase.curves, phase.given)(at.t, at.x, at.u)
    sizes = np.abs(at.x - formula) / phase.scale[:, None]
    return worst_sample(phase.name, phase.form.states, at.t, sizes)


def _culprit(phase: PhaseCase, reason: Unfinished) -> str:
    """The fastest state when the integrator gave up, one without a finite rate first."""
    segments = phase.curves.segments
    speed = np.nan_to_num(np.abs(reason.rates), nan=np.inf)
    row, segment = divmod(int(np.argmax(speed)), segments)
    time = phase.curves.time(np.array(segment), reason.at)
    return f"phase {phase.name}, {phase.form.states[row]}, t = {time:.6g} s"


def _integrated(phase: PhaseCase, start: Array, tolerance: float) -> Array:
    """All segments at once from ``start`` (states, segments) over s: (states, segments, places).

    scipy judges a step by the root mean square over all of it, in which one bad segment of N
    hides behind the others; the tolerance is divided by sqrt(N) to make up for it.
    """
    curves = phase.curves
    half, every = curves.lengths / 2, np.arange(curves.segments)

    def rates(s: float, y: Array) -> Array:
        phase.clock.look()
        u = curves.controls.grid(np.array([s]))[:, :, 0]
        f = phase.dynamics(curves.time(every, s), y.reshape(start.shape), u)
        return np.asarray((f * half).ravel())

    evaluations = max(2_000, min(EVALUATIONS, WORK // start.size))
    tight = min(1e-10, tolerance / 1000) / math.sqrt(curves.segments)
    integrator = Integrator(tight, evaluations)
    motion = [start.ravel()]
    for a, b in itertools.pairwise(PLACES):
        motion.append(integrator.advance(rates, a, motion[-1], b))
    return np.stack(motion, axis=1).reshape(*start.shape, len(PLACES))
