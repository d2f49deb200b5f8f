"""What the steps themselves lose, outside of impacts."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from schemas.results import Check
from solver.certificate.case import Case
from solver.certificate.findings import Finding, judge
from solver.certificate.spatial_steps import SpatialSteps
from solver.certificate.stepped import ContactCase
from solver.certificate.steps import Steps
from solver.numeric import Array

TOUCHES = 1e-6
"""Gaps and rooms below it are none; and closing by less is none, m or rad."""

SHARE = 0.2
"""Of the actuators' work: where more is lost the objective is not yet physical."""


def dissipation(case: Case) -> Check | None:
    """What steps outside of impacts lose by the method, over the actuators' work."""
    return judge("dissipation", list(_shares(case)), SHARE, judged=False)


def lost_per_step(phase: ContactCase) -> Array:
    """What every step outside of impacts loses, J, (N,)."""
    return np.where(impacts(phase.steps), 0.0, phase.energies.dissipation)


def impacts(steps: Steps | SpatialSteps) -> NDArray[np.bool_]:
    """In which steps a contact closes, or a limit is reached, (N,).

    It was open or coming closer before, and touches after. A landing takes up to two steps: one to
    the ground, as fast as that takes, and one in which the rest of the speed is lost.
    """
    gaps = np.minimum(np.concatenate([steps.gaps, steps.rooms]), 1e9)  # no limit is inf away
    forces = np.concatenate([steps.normal, steps.stops.efforts])
    first = steps.first_rates[:, None] * steps.lengths[0]
    change = np.concatenate([first, np.diff(gaps)[:, :-1]], axis=1)
    touching = (gaps[:, 1:] <= TOUCHES) & (forces > 0)
    return np.asarray(np.any(touching & ((gaps[:, :-1] > TOUCHES) | (change < -TOUCHES)), axis=0))


def _shares(case: Case) -> Iterator[Finding]:
    for phase in case.stepped:
        work, lost = float(phase.energies.actuators.sum()), lost_per_step(phase)
        if work > 0:
            worst = phase.steps.ends[int(np.argmax(lost))]
            where = f"phase {phase.name}, {lost.sum():.4g} J of {work:.4g} J"
            yield Finding(float(lost.sum()) / work, f"{where}, most at t = {worst:.6g} s")
