"""How far the method's own sums are from the integrals over the published curves."""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas.expressions import Tree
from schemas.results import PhaseResult
from solver.lowering.form import Form
from solver.numeric import Array, PhaseCurves, along, gauss
from solver.numeric.phase import departure

POINTS, PANELS = 5, 4
"""Gauss-Legendre points on each of equal panels of a segment."""


@np.errstate(all="ignore")  # NaN is an answer here
def integral_errors(
    form: Form,
    trees: Sequence[Tree],
    result: PhaseResult,
    sums: Array,
    statics: Mapping[str, float],
) -> Array:
    """The largest relative error of an integral's share on each segment.

    The mesh error sees the dynamics alone; where an integrand has a kink, or uses derivatives
    that the curves know less well, the objective is the worse of the two.

    Parameters
    ----------
    form, trees
        The phase's motion, and the integrands as the user wrote them.
    sums
        What the method added up, (integrals, segments).

    Returns
    -------
    Shape (segments,), relative to one plus the integral's size; NaN where there is no value.
    """
    if not trees:
        return np.zeros(sums.shape[1])
    curves = PhaseCurves.read(form, result)
    nodes, weights = gauss(POINTS, PANELS)
    at = curves.grid(nodes)
    given = {**statics, **departure(form, curves)}
    values = along(form, trees, given)(at.t, at.x, at.u)
    shares = values.reshape(len(trees), curves.segments, len(nodes)) @ weights
    shares = shares * curves.lengths / 2
    pieces = curves.segments // sums.shape[1]
    shares = shares.reshape(len(trees), sums.shape[1], pieces).sum(axis=2)
    size = 1 + np.abs(shares.sum(axis=1, keepdims=True))
    return np.asarray(np.max(np.abs(sums - shares) / size, axis=0))
