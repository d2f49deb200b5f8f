"""What time steps lose by themselves: the estimator of their error, by the judge's own books."""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.certificate.case import Case
from solver.certificate.losses import lost_per_step
from solver.certificate.stepped import ContactCase
from solver.numeric import MalformedCurves
from solver.numeric.tape import Array


def losses(
    judged: Problem,
    scale: float,
    results: Sequence[PhaseResult],
    statics: Mapping[str, float],
) -> list[Array]:
    """Of each phase what its steps outside of impacts lose, over the actuators' work of all.

    Times ``scale``: other phases beside them have another measure of their meshes.

    Empty for phases that are not stepped. Nothing where the actuators do nothing; not a number
    where the result has none.
    """
    try:
        case = Case.open(judged, results, None, dict(statics))
    except MalformedCurves:
        return [np.full(len(result.knots) - 1, np.nan) for result in results]
    with np.errstate(all="ignore"):
        work = sum(float(phase.energies.actuators.sum()) for phase in case.stepped)
        share = scale / work if work > 0 else 0.0
        return [
            lost_per_step(phase) * share if isinstance(phase, ContactCase) else np.zeros(0)
            for phase in case.phases
        ]
