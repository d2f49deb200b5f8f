"""Is the published objective that of the curves? It is computed anew."""

import math

from schemas.results import Check
from solver.certificate.case import Case
from solver.certificate.findings import Finding, judge
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
    value = evaluate(stated.minimize.tree, _scope(case))
    size = abs(published - value) / (1 + abs(value))
    where = f"published {published:.10g}, recomputed {value:.10g}"
    return judge("objective", [Finding(size, where), *_unsettled(case)], case.tolerance)


def _unsettled(case: Case) -> list[Finding]:
    """Integrals whose own quadrature is no better than the tolerance to judge by."""
    return [
        Finding(math.nan, f"phase {phase.name}, integral {name}: the quadrature does not settle")
        for phase in case.phases
        for name, value, error in zip(
            phase.spec.integrals, phase.integrals.value, phase.integrals.error, strict=True
        )
        if error > 0.1 * case.tolerance * (1 + abs(value))
    ]


def _scope(case: Case) -> dict[str, float]:
    """Every phase's names under its prefix; the only phase's bare as well."""
    scope = {
        f"{phase.name}.{name}": value
        for phase in case.phases
        for name, value in phase.scope.items()
    }
    return scope | case.phases[0].scope if len(case.phases) == 1 else scope
