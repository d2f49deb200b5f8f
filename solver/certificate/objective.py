"""Is the published objective that of the curves? It is computed anew."""

import math

from schemas.results import Check
from solver.certificate.case import Case
from solver.certificate.findings import Finding, judge
from solver.certificate.unsettled import unsettled
from solver.numeric import evaluate


def objective(case: Case) -> Check | None:
    """The objective computed anew from the curves, against the published one.

    Integrals are over the true curves, by an adaptive quadrature that knows nothing of the
    method's own weights. Relative to one plus the objective's size.
    """
    stated = case.problem.objective
    if stated is None:
        return None
    published = math.nan if case.objective is None else case.objective
    value = evaluate(stated.minimize.tree, case.scope)
    size = abs(published - value) / (1 + abs(value))
    where = f"published {published:.10g}, recomputed {value:.10g}"
    vague = unsettled(case, stated.minimize.tree, case.tolerance)
    return judge("objective", [Finding(size, where), *vague], case.tolerance)
