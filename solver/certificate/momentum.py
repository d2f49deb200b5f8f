"""The audit of momentum: of all that moves together, and along every coordinate."""

from collections.abc import Iterator, Sequence

import numpy as np

from schemas.results import Check
from solver.certificate.balance import Balance, accelerations, at_ends, averaged, together
from solver.certificate.case import Case
from solver.certificate.findings import Finding, judge, worst_sample
from solver.certificate.losses import impacts
from solver.certificate.spatial_averages import spatial_averaged
from solver.certificate.spatial_balance import spatial_at_ends, whole_momentum
from solver.certificate.spatial_steps import SpatialSteps
from solver.certificate.stepped import ContactCase
from solver.certificate.steps import Steps
from solver.numeric import Array

MOMENTUM = 1e-3
"""Of the impulses that make up a balance."""

FAINT = 1e-5
"""Of the largest impulses: less is next to nothing."""


def momentum(case: Case) -> Check | None:
    """Impulses of gravity, contacts and whatever else is outside against the change of momentum.

    In every step, relative to the largest impulses of one, and over the phase, relative to all of
    them. Of what floats or slides from the ground, whole, with all that it carries.
    """
    findings = [finding for phase in case.stepped for finding in _whole(phase)]
    return judge("momentum", findings, MOMENTUM)


def equations_of_motion(case: Case) -> Check | None:
    """The same along every coordinate, as the method of the steps has it."""
    findings = [
        _steps(phase, _balance(phase.steps), phase.steps.model.coordinates)
        for phase in case.stepped
    ]
    return judge("equations of motion", findings, MOMENTUM)


def forward_dynamics(case: Case) -> Check | None:
    """Accelerations of the steps against the simulator's under the published forces.

    The difference goes to zero with the length of the steps. In the plane, and without impacts.
    """
    findings = [finding for phase in case.stepped for finding in _accelerations(phase)]
    return judge("forward dynamics", findings, tolerance=None, judged=False)


def _balance(steps: Steps | SpatialSteps) -> Balance:
    if isinstance(steps, SpatialSteps):
        return spatial_averaged(steps) if steps.faithful else spatial_at_ends(steps)
    return averaged(steps) if steps.faithful else at_ends(steps)


def _whole(phase: ContactCase) -> Iterator[Finding]:
    steps = phase.steps
    found = whole_momentum(steps) if isinstance(steps, SpatialSteps) else together(steps)
    if found is None:
        return
    balance, names = found
    yield _steps(phase, balance, names)
    sums = np.abs(balance.left.sum(axis=1)) - balance.doubt.sum(axis=1)
    sizes = np.maximum(sums, 0.0) / _positive(balance.sizes.sum(axis=1))
    worst = int(np.argmax(sizes))
    yield Finding(float(sizes[worst]), f"phase {phase.name}, {names[worst]}, over all steps")


def _steps(phase: ContactCase, balance: Balance, names: Sequence[str]) -> Finding:
    largest = _positive(balance.sizes.max(axis=1))
    sizes = balance.beyond / largest[:, None]
    return worst_sample(phase.name, names, phase.steps.ends, sizes)


def _accelerations(phase: ContactCase) -> Iterator[Finding]:
    steps, smooth = phase.steps, ~impacts(phase.steps)
    if isinstance(steps, SpatialSteps) or not smooth.any():
        return
    own, free = (rows[:, smooth] for rows in accelerations(steps))
    sizes = np.abs(own - free) / (1 + np.abs(free).max())
    names = [f"dd({name})" for name in phase.steps.model.coordinates]
    yield worst_sample(phase.name, names, phase.steps.ends[smooth], sizes)


def _positive(sizes: Array) -> Array:
    """Where next to nothing pushes, something that is left over is compared with the rest.

    Of forces that balance, a solver leaves as much as its tolerance.
    """
    return np.asarray(np.maximum(sizes, FAINT * max(float(sizes.max()), 1e-300)))
