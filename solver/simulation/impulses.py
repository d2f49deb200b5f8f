"""Which contacts push, stick and slide: one linear complementarity problem for all of them.

The same problem answers for accelerations under forces and for velocities under impulses:

    x = x0 + P (Jn' n + Jt' t),   0 <= n _|_ Jn x + an >= 0,   t by Coulomb's law from Jt x + at.

Sources: Stewart and Trinkle, International Journal for Numerical Methods in Engineering 39
(1996); for accelerations Glocker and Pfeiffer, Multibody Dynamics with Unilateral Contacts.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.numeric.tape import Array
from solver.simulation.lcp import LcpStatus, solve_lcp

DEPENDENT = 1e-10
"""Singular values below this share of the largest belong to rows that others imply."""


class Free(NamedTuple):
    """What moves without unilateral contacts: x0 (n,), and the inverse mass P (n, n).

    Loops are already in both: ``G x0 = g`` and ``G P = 0``.
    """

    x: Array
    P: Array


def free(mass: Array, push: Array, loops: tuple[Array, Array] | None = None) -> Free:
    """The motion under ``M x = push`` and, with ``loops`` = (G, g), G x = g.

    Parameters
    ----------
    mass
        Shape (n, n).
    push
        Shape (n,): forces, or momenta.
    loops
        G (rows, n) and g (rows,); dependent rows do no harm.
    """
    inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
    x = inverse @ push
    if loops is None or not len(loops[1]):
        return Free(x, inverse)
    G, g = loops
    toward = inverse @ G.T
    pull = toward @ np.linalg.pinv(G @ toward, rcond=DEPENDENT)
    return Free(x + pull @ (g - G @ x), inverse - pull @ toward.T)


@dataclass(frozen=True, slots=True)
class Touching:
    """The contacts that may push, c of them.

    Attributes
    ----------
    Jn, Jt
        Shape (c, n).
    normal, slip
        What is added to ``Jn x`` and ``Jt x``, (c,).
    friction
        Coefficients, (c,).
    sliding
        -1 or 1 where a contact slides in a direction that is known, along which friction brakes;
        0 where Coulomb's law chooses, (c,).
    """

    Jn: Array
    Jt: Array
    normal: Array
    slip: Array
    friction: Array
    sliding: Array

    def subset(self, some: NDArray[np.intp]) -> "Touching":
        """A part of them."""
        return Touching(
            self.Jn[some],
            self.Jt[some],
            self.normal[some],
            self.slip[some],
            self.friction[some],
            self.sliding[some],
        )


class Pushes(NamedTuple):
    """Forces, or impulses, of all contacts (c,), and what moves then, x (n,).

    ``slides`` says of contacts under Coulomb's choice that they are at the edge of the cone.
    """

    normal: Array
    tangential: Array
    slides: NDArray[np.bool_]
    x: Array
    status: LcpStatus


def push(motion: Free, touching: Touching) -> Pushes:
    """Solve for all contacts at once.

    Unknowns of the problem: the normal forces; where Coulomb's law chooses, the friction in the
    two directions of the plane, and the speed at which the contact slides.
    """
    count = len(touching.friction)
    chosen = np.flatnonzero((touching.sliding == 0) & (touching.friction > 0))
    known = -np.sign(touching.sliding) * touching.friction
    Jt, slip = touching.Jt[chosen], touching.slip[chosen]
    along = np.concatenate([touching.Jn, Jt, -Jt])
    toward = np.concatenate([touching.Jn + known[:, None] * touching.Jt, Jt, -Jt])
    offset = np.concatenate([touching.normal, slip, -slip])
    M = _with_cones(along @ motion.P @ toward.T, chosen, touching.friction[chosen])
    q = np.zeros(len(M))
    q[: len(offset)] = along @ motion.x + offset
    found = solve_lcp(M, q)
    normal, tangential = found.z[:count], known * found.z[:count]
    right, left = np.split(found.z[count : count + 2 * len(chosen)], 2)
    tangential[chosen] = right - left
    slides = np.zeros(count, dtype=bool)
    slides[chosen] = found.z[count + 2 * len(chosen) :] > 0
    x = motion.x + motion.P @ (touching.Jn.T @ normal + touching.Jt.T @ tangential)
    return Pushes(normal, tangential, slides, x, found.status)


def _with_cones(compliance: Array, chosen: NDArray[np.intp], friction: Array) -> Array:
    """The rows of Coulomb's law below those of the contacts: mu n - t+ - t- over the speed."""
    forces, count = len(compliance), len(chosen)
    first = forces - 2 * count
    M = np.zeros((forces + count, forces + count))
    M[:forces, :forces] = compliance
    cones = np.arange(forces, forces + count)
    M[cones, chosen] = friction
    for side in (first, first + count):
        rows = np.arange(side, side + count)
        M[rows, cones] = 1.0
        M[cones, rows] = -1.0
    return M
