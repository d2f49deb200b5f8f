"""How far the published curves leave their limits between the nodes, segment by segment."""

import numpy as np

from schemas import resolve
from schemas.expressions import Name, Tree
from schemas.phases import Constraint, Phase
from schemas.results import PhaseResult
from schemas.values import Bound
from solver.certificate.case import SAMPLES
from solver.certificate.findings import violation
from solver.lowering.form import Form
from solver.numeric import Array, PhaseCurves, along
from solver.numeric.phase import departure


@np.errstate(all="ignore")  # NaN is an answer here
def excess(
    phase: Phase, form: Form, result: PhaseResult, statics: dict[str, float], segments: int
) -> Array:
    """The largest violation of a bound or a path constraint in each segment.

    Methods keep limits at their nodes. The mesh error does not see what happens between them;
    the certificate does, and looks at the same places.

    Parameters
    ----------
    segments
        Of the mesh; a curve may have several pieces on each.

    Returns
    -------
    Shape (segments,), relative to one plus the limit's size; NaN where there is no value.
    """
    rows: list[tuple[Tree, Bound | Constraint]] = [
        *((Name(name), bound) for name, bound in phase.bounds.items()),
        *((row.expression.tree, row) for row in phase.path),
    ]
    if not rows:
        return np.zeros(segments)
    curves = PhaseCurves.read(form, result)
    at = curves.grid(np.linspace(-1.0, 1.0, SAMPLES))
    given = {**statics, **departure(form, curves)}
    values = along(form, [tree for tree, _ in rows], given)(at.t, at.x, at.u)
    constants = resolve.parameters(phase.system)
    sizes = [
        violation(value, resolve.interval(limits, constants))
        for value, (_, limits) in zip(values, rows, strict=True)
    ]
    return np.asarray(np.max(np.array(sizes), axis=0).reshape(segments, -1).max(axis=1))
