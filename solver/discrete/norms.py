"""Quaternions among the coordinates: what pushes along them does no work, and is left out."""

from collections.abc import Sequence

import casadi as ca

from solver.discrete.chord import Column
from solver.expressions import SX
from solver.mechanics.principle import Principle


def without_norms(principle: Principle, ends: tuple[Column, Column], pulls: SX) -> SX:
    """The balance without what would push along a quaternion, and the norms in its place.

    Where both ends have the norm 1, the change of a quaternion is at right angles to its mean, and
    three rows at right angles to that say all of the balance that does any work.
    """
    (q0, q1), rows = ends, ca.vertsplit(pulls)
    for places in principle.norms:
        mean = [(q0[i] + q1[i]) / 2 for i in places]
        pull = [rows[i] for i in places]
        turned = [ca.dot(ca.vertcat(*across), ca.vertcat(*pull)) for across in _across(mean)]
        norm = sum((q1[i] ** 2 for i in places), SX(-1))
        for place, row in zip(places, (norm, *turned), strict=True):
            rows[place] = row
    return ca.vertcat(SX(0, 1), *rows)


def _across(p: Sequence[SX]) -> Sequence[Sequence[SX]]:
    """Three vectors at right angles to a quaternion, and to each other."""
    w, x, y, z = p
    return (-x, w, z, -y), (-y, -z, w, x), (-z, y, -x, w)
