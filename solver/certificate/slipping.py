"""How far touching matter slips over a step, from where it is at both ends of it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.numeric import Array
from solver.simulation.instant import Instant


class _Ends(NamedTuple):
    """Of one pair at the knots, (N + 1,), in the frame of what it touches.

    ``at`` is the contact's place and ``tangent`` the unit vector along the outline, complex;
    ``turn`` and ``other`` the angles of both bodies to the world, ``reach`` from the other's middle
    to the contact in the world.
    """

    at: NDArray[np.complex128]
    tangent: NDArray[np.complex128]
    reach: NDArray[np.complex128]
    turn: Array
    other: Array


def slipped(knots: Instant, round_ones: Sequence[bool]) -> Array:
    """Of every pair over every step, m, (pairs, N): positive along the tangent.

    On the ground and about an ellipse the change of the contact's place, as seen from what it
    touches, along the mean tangent, and what a circle rolls: with its radius r and the turns a of
    its body and b of the other one, ``t . dp + r (da - db)``. About a circle, for which
    ``round_ones`` is true, arcs: at the mean distance R in the direction f, ``-R df + r da +
    (R - r) db``. A contact that stays at its place on the outline slips by nothing, whatever the
    step.
    """
    radii = knots.parts.touch.radii
    rows = [
        _arc(_ends(knots, pair), radii[pair]) if one else _chord(_ends(knots, pair), radii[pair])
        for pair, one in enumerate(round_ones)
    ]
    return np.reshape(rows, (len(rows), len(knots.t) - 1))


def _ends(knots: Instant, pair: int) -> _Ends:
    touch, pose = knots.parts.touch, knots.pose
    own, other = (bodies[pair] for bodies in touch.bodies)
    first, second = (places[pair] @ pose.features for places in touch.places)
    back, reach = pose.turns[other].conj(), first - second
    tangent = -1j * back * knots.contacts.normals[pair]
    return _Ends(back * reach, tangent, reach, pose.angles[own], pose.angles[other])


def _chord(ends: _Ends, radius: float) -> Array:
    mean = (ends.tangent[:-1] + ends.tangent[1:]) / 2
    rolled = radius * np.diff(ends.turn - ends.other)
    return np.asarray((mean.conj() * np.diff(ends.at)).real + rolled)


def _arc(ends: _Ends, radius: float) -> Array:
    far = (np.abs(ends.reach[:-1]) + np.abs(ends.reach[1:])) / 2
    around = np.angle(ends.reach[1:] / ends.reach[:-1])
    turned = radius * np.diff(ends.turn) + (far - radius) * np.diff(ends.other)
    return np.asarray(turned - far * around)
