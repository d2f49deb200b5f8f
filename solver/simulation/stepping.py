"""Time stepping: fixed steps, in which the impulses of all contacts are found at once.

    M (v1 - v0) = h f + Jn' n + Jt' t + loops,     q1 = q0 + h v1,
    0 <= n _|_ gap / h + Jn v1 >= 0,               t by Coulomb's law from Jt v1,

all of it at q0: gaps are linearised, so that a step needs one linear complementarity problem.
First order in h. Sources: Stewart and Trinkle, International Journal for Numerical Methods in
Engineering 39 (1996); Anitescu and Potra, Nonlinear Dynamics 14 (1997). Restitution is Newton's.

Where a contact lands within a step, the step is cut there. An impact is then one problem, as its
law has it; in two parts, one that ends on the ground and one that stops, friction that reverses
between them would depend on where in the step the landing falls.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.numeric.tape import Array
from solver.simulation.impulses import Free, Pushes, Touching, free, push
from solver.simulation.instant import Instant
from solver.simulation.lcp import LcpStatus
from solver.simulation.unilateral import Rows, Unilateral

CUTS = 4
"""Into so many parts landings cut a step at the most."""


class Stepped(NamedTuple):
    """The end of a step: the state (2 n,), and the impulses of all constraints (c,), N s.

    ``approach`` are the gap rates before the step; ``gap_rates`` and ``slips`` those after, (c,).
    """

    state: Array
    normal: Array
    tangential: Array
    approach: Array
    gap_rates: Array
    slips: Array
    status: LcpStatus


class _Look(NamedTuple):
    """A mechanism at the start of a step."""

    at: Instant
    rows: Rows

    def motion(self, h: float) -> Free:
        """The velocities at the end of a step without contacts; loops close by it."""
        rows, mass = self.rows, self.at.mass[0]
        loops = (rows.loop_slopes[..., 0], -rows.loop_gaps[:, 0] / h)
        return free(mass, mass @ self.at.v[:, 0] + h * self.at.applied[:, 0], loops)


@dataclass(frozen=True, slots=True)
class Stepper:
    """Makes steps of a mechanism."""

    system: Unilateral

    def step(self, time: float, state: Array, h: float) -> Stepped:
        """One step of length ``h``, s, from a state (2 n,)."""
        normal, tangential, approach = np.zeros((3, len(self.system.names)))
        left, first = h, True
        for cut in range(CUTS):
            at = self.system.at(np.array([time + h - left]), state[:, None])
            look = _Look(at, self.system.rows(at))
            motion = look.motion(left)
            part = left if cut == CUTS - 1 else _until_landing(look, motion, left)
            motion = motion if part == left else look.motion(part)
            found = self._part(look, motion, state, part)
            state = found.state
            normal, tangential = normal + found.normal, tangential + found.tangential
            fresh = (found.normal > 0) | first
            approach = np.where(fresh, found.approach, approach)
            left, first = left - part, False
            if left <= 0 or found.status is not LcpStatus.SOLVED:
                break
        return Stepped(
            state, normal, tangential, approach, found.gap_rates, found.slips, found.status
        )

    def _part(self, look: _Look, motion: Free, state: Array, h: float) -> Stepped:
        rows = look.rows
        found, some = self._pushed(motion, rows, h)
        normal, tangential = np.zeros((2, len(self.system.names)))
        normal[some], tangential[some] = found.normal, found.tangential
        after = np.concatenate([state[: len(found.x)] + h * found.x, found.x])
        rates, slips = rows.Jn[..., 0] @ found.x, rows.Jt[..., 0] @ found.x
        return Stepped(after, normal, tangential, rows.rates[:, 0], rates, slips, found.status)

    def _pushed(self, motion: Free, rows: Rows, h: float) -> tuple[Pushes, NDArray[np.intp]]:
        """The impulses of those that touch within the step.

        First of those that would do so freely; the impulses may bring others.
        """
        Jn, gaps = rows.Jn[..., 0], rows.gaps[:, 0]
        touches = gaps + h * (Jn @ motion.x) < 0
        while True:
            some = np.flatnonzero(touches)
            found = push(motion, self._touching(motion, rows, some, h))
            more = touches | (gaps + h * (Jn @ found.x) < -1e-12)
            if np.all(more == touches) or found.status is not LcpStatus.SOLVED:
                return found, some
            touches = more

    def _touching(self, motion: Free, rows: Rows, some: NDArray[np.intp], h: float) -> Touching:
        """Speeds that the forces make within a step do not rebound: what rests would hover."""
        closing, rates = rows.gaps[some, 0] / h, rows.rates[some, 0]
        made = np.abs(rows.Jn[some, :, 0] @ motion.x - rates)
        rebound = np.where(rates < -2 * made, self.system.restitution[some] * rates, 0.0)
        return Touching(
            rows.Jn[some, :, 0],
            rows.Jt[some, :, 0],
            np.where(rebound < 0, np.minimum(closing, rebound), closing),
            np.zeros(len(some)),
            self.system.friction[some],
            np.zeros(len(some)),
        )

    def within(self, time: float) -> "Stepper":
        """The same, in another piece of what drives it."""
        return replace(self, system=self.system.piece(time))


def _until_landing(look: _Look, motion: Free, h: float) -> float:
    """The part of ``h`` up to where a contact lands that is not only pressed down."""
    gaps, rates = look.rows.gaps[:, 0], look.rows.rates[:, 0]
    moving = look.rows.Jn[..., 0] @ motion.x
    lands = (gaps > 0) & (gaps + h * moving < 0) & (rates < -2 * np.abs(moving - rates))
    if not np.any(lands):
        return h
    part = float(np.min(gaps[lands] / -moving[lands]))
    return part if 1e-3 * h < part else h
