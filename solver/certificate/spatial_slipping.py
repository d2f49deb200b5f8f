"""How far the matter of contacts slips over a step in space, from where it is at both ends."""

import numpy as np

from solver.numeric import Array
from solver.simulation.spatial_instant import SpatialInstant


def spatial_slipped(knots: SpatialInstant) -> Array:
    """Of every contact over every step along x and y, m, (2, contacts, N).

    The change of the contact's centre, and what a sphere of radius r rolls on level ground while
    its link turns by a vector theta: ``theta x (-r z)``.
    """
    found = np.zeros((2, len(knots.centres), len(knots.t) - 1))
    for row, (name, centre) in enumerate(knots.centres.items()):
        radius = knots.parts.numbers.radii[name]
        found[:, row] = np.diff(centre.place[:, :2], axis=0).T
        if radius:
            x, y, _ = turned(centre.axes).T
            found[:, row] += radius * np.array([-y, x])
    return found


def turned(axes: Array) -> Array:
    """The vectors of the turns from each of some rotations (N + 1, 3, 3) to the next, rad, (N, 3).

    Less than half a turn each.
    """
    turn = axes[1:] @ np.swapaxes(axes[:-1], 1, 2)
    across = turn - np.swapaxes(turn, 1, 2)
    vector = np.stack([across[:, 2, 1], across[:, 0, 2], across[:, 1, 0]], axis=1) / 2
    sine = np.linalg.norm(vector, axis=1)
    angle = np.arctan2(sine, (np.trace(turn, axis1=1, axis2=2) - 1) / 2)
    grown = np.divide(angle, sine, out=np.ones_like(sine), where=sine > 0)
    return np.asarray(grown[:, None] * vector)
