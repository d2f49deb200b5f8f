"""The balance of momentum of discrete-gradient steps in space, along the coordinates."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from solver.certificate.balance import Balance
from solver.certificate.spatial_chords import spatial_chords
from solver.certificate.spatial_energies import damped, users
from solver.certificate.spatial_slopes import SlopeFrame, slope_frames
from solver.certificate.spatial_steps import SpatialSteps
from solver.numeric import Array


def spatial_averaged(steps: SpatialSteps) -> Balance:
    """With the rows that give true changes; what pushes along a quaternion is left out.

    Its change is at right angles to the mean of both ends, where these have the norm 1.
    """
    system, told, h = steps.model.system, steps.published, steps.lengths
    frames = slope_frames(system.carriages, system.coordinates, told.q)
    rows: dict[str, Array] = defaultdict(lambda: np.zeros_like(steps.moved))
    for word, pull in _pulls(steps, frames):
        rows[word] += pull
    for row, joint in enumerate(system.motor_joints):
        rows["motors"][system.coordinates.index(joint)] += h * told.u[row]
    rows["damping"] += h * damped(steps)
    rows["stops"] += h * (steps.stops.slopes.T @ steps.stops.efforts)
    values = np.array(list(rows.values()))
    for first in system.balls:
        start = system.coordinates.index(first)
        places = slice(start, start + 4)
        values[:, places] = _across(values[:, places], told.q[places])
    return Balance(tuple(rows), values, np.zeros_like(steps.moved))


def _across(rows: Array, q: Array) -> Array:
    """Rows (terms, 4, N) without what is along the mean quaternion of each step."""
    mean = (q[:, 1:] + q[:, :-1]) / 2
    part = np.einsum("tkN,kN->tN", rows, mean) / np.sum(mean**2, axis=0)
    return np.asarray(rows - part[:, None] * mean)


def _pulls(steps: SpatialSteps, frames: dict[str, SlopeFrame]) -> Iterator[tuple[str, Array]]:
    """What inertia, weight, contacts and the user's forces are along the coordinates, (n, N)."""
    h, gravity = steps.lengths[:, None], steps.model.numbers.gravity
    for one in spatial_chords(steps):
        frame = frames[one.host]
        moves = frame.shifted(one.com).moves
        yield "motion", _pulled(moves, -one.mass * one.jumps[0])
        yield "motion", _pulled(frame.rolled(own=True), -one.turning)
        yield "gravity", _pulled(moves, one.mass * h * gravity)
    for name, force in users(steps):
        frame = frames[steps.model.system.forces[name].link]
        yield "users", _pulled(frame.shifted(steps.model.numbers.places[name]).moves, h * force)
    for name, normal, x, y in zip(steps.pairs, steps.normal, *steps.tangential, strict=True):
        moves = _contact(steps, name, frames[steps.model.system.contacts[name].link])
        yield "contacts", _pulled(moves, h * np.stack([x, y, normal], axis=1))


def _contact(steps: SpatialSteps, name: str, frame: SlopeFrame) -> Array:
    """The rows of a contact's slips and gap, (N, 3, n)."""
    numbers = steps.model.numbers
    moves = frame.shifted(numbers.centres[name]).moves.copy()
    if radius := numbers.radii[name]:
        turn = frame.rolled()
        moves[:, :2] += radius * np.stack([-turn[:, 1], turn[:, 0]], axis=1)
    return moves


def _pulled(rows: Array, impulses: Array) -> Array:
    return np.asarray(np.einsum("Nkn,Nk->nN", rows, impulses))
