"""Impacts: velocities that change at once, under impulses of all contacts that touch.

Newton's law of restitution for the normals, Coulomb's law for the impulses; both hold together
as one complementarity problem. With friction Newton's law may create energy (Kane's puzzle);
here it never does: so much of the rebound is taken as leaves the kinetic energy where it was.
"""

from typing import NamedTuple

import numpy as np

from solver.numeric.tape import Array
from solver.simulation.impulses import DEPENDENT, Free, Touching, push
from solver.simulation.lcp import LcpStatus


class Impact(NamedTuple):
    """Impulses of the contacts (c,), N s, and the velocities after them (n,)."""

    normal: Array
    tangential: Array
    v: Array
    status: LcpStatus


def collide(motion: Free, mass: Array, touching: Touching, restitution: Array) -> Impact:
    """What an impact makes of the velocities ``motion.x``.

    Parameters
    ----------
    motion
        The velocities before, which satisfy the loops, and the inverse mass.
    mass
        Shape (n, n), for the kinetic energy.
    touching
        All contacts without a gap, those at rest, too; nothing is known of their sliding.
    restitution
        Coefficients, (c,).
    """
    plastic = push(motion, touching)
    rates = touching.Jn @ motion.x
    rebound = restitution * np.minimum(rates, 0.0)
    if plastic.status is not LcpStatus.SOLVED or not np.any(rebound < 0):
        return Impact(plastic.normal, plastic.tangential, plastic.x, plastic.status)
    bouncing = Touching(
        touching.Jn, touching.Jt, rebound, touching.slip, touching.friction, touching.sliding
    )
    elastic = push(motion, bouncing)
    if elastic.status is not LcpStatus.SOLVED:
        return Impact(plastic.normal, plastic.tangential, plastic.x, plastic.status)
    share = _share(mass, motion.x, plastic.x, elastic.x)
    return Impact(
        _between(plastic.normal, elastic.normal, share),
        _between(plastic.tangential, elastic.tangential, share),
        _between(plastic.x, elastic.x, share),
        elastic.status,
    )


def _between(first: Array, second: Array, share: float) -> Array:
    return np.asarray((1 - share) * first + share * second)


def _share(mass: Array, before: Array, plastic: Array, elastic: Array) -> float:
    """How much of the rebound the energy before allows, 0 to 1.

    The energy along the line from the plastic to the elastic velocities is a convex parabola,
    and at its start not above the energy before.
    """
    way = elastic - plastic
    square, slope = float(way @ mass @ way), float(plastic @ mass @ way)
    excess = float(plastic @ mass @ plastic - before @ mass @ before)
    if square + 2 * slope + excess <= 0 or square == 0:
        return 1.0
    root = np.sqrt(max(slope**2 - square * min(excess, 0.0), 0.0))
    return float(np.clip((root - slope) / square, 0.0, 1.0))


def brought_to_rest(motion: Free, rows: Array) -> Array:
    """The velocities (n,) nearest to ``motion.x``, by their energy, at which ``rows @ v = 0``."""
    if not len(rows):
        return motion.x
    toward = motion.P @ rows.T
    pull = np.linalg.pinv(rows @ toward, rcond=DEPENDENT)
    return np.asarray(motion.x - toward @ (pull @ (rows @ motion.x)))
