"""The balance of momentum of every step in space."""

import numpy as np

from solver.certificate.balance import Balance
from solver.certificate.spatial_energies import users
from solver.certificate.spatial_steps import SpatialSteps
from solver.numeric import Array


def spatial_at_ends(steps: SpatialSteps) -> Balance:
    """Along the coordinates, with everything at the end of the step: 000, section 3.1."""
    at, h = steps.last, steps.lengths
    rows = {
        "motion": -np.einsum("Nij,jN->iN", at.mass, steps.chords - steps.before),
        "applied": h * at.applied.T,
        "normal": np.zeros_like(steps.moved),
        "friction": np.zeros_like(steps.moved),
        "stops": h * (steps.stops.slopes.T @ steps.stops.efforts),
    }
    for name, normal, x, y in zip(steps.pairs, steps.normal, *steps.tangential, strict=True):
        J, _ = at.rows(name)
        rows["normal"] += h * (J[:, 0].T * normal)
        rows["friction"] += h * (J[:, 1].T * x + J[:, 2].T * y)
    return Balance(tuple(rows), np.array(list(rows.values())), np.zeros_like(steps.moved))


def whole_momentum(steps: SpatialSteps) -> tuple[Balance, list[str]] | None:
    """Of everything together along the axes in which the base is free, and what these are called.

    By the true change of the centre of mass over each step, whatever the steps say of it.
    """
    free = {"floating": "xyz", "planar": "xz", "fixed": ""}[steps.model.system.base]
    if not free:
        return None
    axes = ["xyz".index(axis) for axis in free]
    h, mass, at = steps.lengths, steps.last.mass_total, steps.knots
    after = np.diff(at.com, axis=0).T / h
    before = np.concatenate([at.momentum[:1].T / mass, after[:, :-1]], axis=1)
    pushed = [force for _, force in users(steps)]
    rows = {
        "motion": -mass * (after - before),
        "gravity": mass * np.multiply.outer(steps.model.numbers.gravity, h),
        "users": h * np.sum(pushed, axis=0).T if pushed else np.zeros_like(after),
        "contacts": h * _pressed(steps),
    }
    values = np.array(list(rows.values()))[:, axes]
    return Balance(tuple(rows), values, np.zeros_like(values[0])), [f"com.p{x}" for x in free]


def _pressed(steps: SpatialSteps) -> Array:
    """The forces of all contacts together, N, (3, N)."""
    x, y = steps.tangential.sum(axis=1)
    return np.array([x, y, steps.normal.sum(axis=0)])
