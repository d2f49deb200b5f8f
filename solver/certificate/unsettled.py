"""Integrals that are known too badly to judge by."""

import math

from schemas.expressions import Tree
from solver.certificate.case import AnyPhase, Case
from solver.certificate.findings import Finding
from solver.lowering.used import integrals_in


def unsettled(
    case: Case, tree: Tree, tolerance: float, within: AnyPhase | None = None
) -> list[Finding]:
    """Integrals in a tree whose own quadrature is no better than the tolerance to judge by.

    ``within`` is the phase in which the tree stands, if it stands in one.
    """
    found = {phase.name: phase.integrals for phase in case.phases}
    return [
        Finding(math.nan, f"phase {phase}, integral {name}: the quadrature does not settle")
        for phase, name in integrals_in(tree, case.problem, within.spec if within else None)
        if found[phase][name].error > 0.1 * tolerance * (1 + abs(found[phase][name].value))
    ]
