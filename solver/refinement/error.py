"""The mesh error: how far the published curves are from their own dynamics, segment by segment."""

from collections.abc import Mapping

import numpy as np

from schemas.results import PhaseResult
from solver.lowering.form import Form
from solver.numeric import Array, PhaseCurves, dynamics, flow, gauss

POINTS, PANELS = 5, 4
"""Gauss-Legendre points on each of equal panels of a segment.

The integrand is an absolute value. It has kinks at the collocation points, which for trapezoidal
and Hermite-Simpson lie on panels' ends, and is smooth between them. Measured on examples: a
single panel is off by 12 % with 5 points and by 2 % with 10, two panels of 5 by less than 1e-8 in
the largest error; four cost the same and serve where the defect changes its sign elsewhere too.
"""

EVEN = np.linspace(-1.0, 1.0, 9)
"""Where in a segment sizes and distances are looked for."""


@np.errstate(all="ignore")  # NaN is an answer here
def segment_errors(form: Form, result: PhaseResult, statics: Mapping[str, float]) -> Array:
    """The relative error of every segment (003, section 7.6.3; the contract's mesh error).

    eta = integral over the segment of abs(x' - f(t, x, u)) for each state; the error is the
    largest eta / (1 + max abs(x)) over the states, the maximum over the whole phase. Implicit
    systems are solved for their accelerations first, so that methods compare. A closed form has
    no defect; its eta is the largest distance of the curve from the formula.

    Parameters
    ----------
    form
        Gives the dynamics.
    result
        Gives the curves; the segments lie between the breaks of states and controls together.
    statics
        The values of the problem's free parameters.

    Returns
    -------
    Shape (segments,), dimensionless; NaN where the dynamics have no value.

    Raises
    ------
    MalformedCurves
        If the curves cannot be read.
    """
    curves = PhaseCurves.read(form, result)
    eta = _distances(form, curves, statics) if form.flow else _defects(form, curves, statics)
    largest = np.abs(curves.states.grid(EVEN)).max(axis=(1, 2))
    return np.asarray(np.max(eta / (1 + largest[:, None]), axis=0))


def _defects(form: Form, curves: PhaseCurves, statics: Mapping[str, float]) -> Array:
    """The integral of abs(x' - f) over each segment, (states, segments)."""
    nodes, weights = gauss(POINTS, PANELS)
    at = curves.grid(nodes)
    shape = (len(at.x), curves.segments, len(nodes))
    half = curves.lengths[:, None] / 2
    # Over s in [-1, 1]: no division by a segment's length, which may be zero.
    rates = dynamics(form, statics)(at.t, at.x, at.u).reshape(shape) * half
    return np.asarray(np.abs(curves.states.slopes().grid(nodes) - rates) @ weights)


def _distances(form: Form, curves: PhaseCurves, statics: Mapping[str, float]) -> Array:
    """How far the curves of a closed form are from its formula, (states, segments)."""
    at = curves.grid(EVEN)
    distances = np.abs(at.x - flow(form, curves, statics)(at.t, at.x, at.u))
    return np.asarray(distances.reshape(len(at.x), curves.segments, -1).max(axis=2))
