"""What happens at an instant: contacts collide, and what touches then sticks, slides or parts."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.numeric.tape import Array
from solver.simulation.automaton import Moment
from solver.simulation.held import CLOSED, FRICTIONLESS, LEFT, OPEN, RIGHT, STICKING, Touch
from solver.simulation.impacts import Impact, brought_to_rest, collide
from solver.simulation.impulses import DEPENDENT, Free, Pushes, Touching, free, push
from solver.simulation.lcp import LcpStatus
from solver.simulation.unilateral import Rows, Unilateral

NEAR = 1e-8
"""Gaps below it touch, m."""

STILL = 1e-9
"""Speeds below it are none, m/s."""

NONE = 1e-12
"""Accelerations below this share of the others are none."""


@dataclass(frozen=True, slots=True)
class Settled:
    """The mode and the state (2 n,) after an instant, and the impact that there was.

    Attributes
    ----------
    touching
        The contacts without a gap, to which ``impact`` refers.
    before, after
        Their gap rates.
    solved
        False where no forces and no impulses agree with the laws: Painleve's paradox.
    """

    touch: Touch
    state: Array
    touching: NDArray[np.intp]
    impact: Impact | None = None
    before: Array | None = None
    after: Array | None = None
    solved: bool = True


class _Here(NamedTuple):
    """One point: the mass (n, n), the applied forces (n,), the rows, all of N = 1."""

    mass: Array
    applied: Array
    rows: Rows


def settle(
    system: Unilateral, moment: Moment, escape: float, before: Touch | None = None
) -> Settled:
    """Collide where contacts approach, then choose what each of them does.

    What was held ``before`` has drifted by the integrator's error; it is taken back first.
    """
    time, state = moment.time, moment.state
    if before is not None:
        state = _projected(system, time, state, before)
    here = _look(system, time, state)
    touching = np.flatnonzero(here.rows.gaps[:, 0] <= NEAR)
    approach = here.rows.rates[touching, 0]
    impact = None
    if np.any(approach < -STILL):
        impact, v = _collided(system, here, touching, state, escape)
        state = np.concatenate([state[: len(v)], v])
        if impact.status is not LcpStatus.SOLVED:
            nothing = Touch((OPEN,) * len(system.names))
            return Settled(nothing, state, touching, impact, approach, approach, solved=False)
        here = _look(system, time, state)
    after = here.rows.rates[touching, 0]
    resting = touching[after <= STILL]
    touch, solved = _choose(system, here, resting)
    state = _projected(system, time, state, touch)
    return Settled(touch, state, touching, impact, approach, after, solved)


def _look(system: Unilateral, time: float, state: Array) -> _Here:
    at = system.at(np.array([time]), state[:, None])
    return _Here(at.mass[0], at.applied[:, 0], system.rows(at))


def _collided(
    system: Unilateral, here: _Here, touching: NDArray[np.intp], state: Array, escape: float
) -> tuple[Impact, Array]:
    """The impact, and the velocities after it: what parts too slowly stays.

    So does what slips as slowly: a stop that leaves a trace of slip would tip a block again.
    """
    v = state[len(state) // 2 :]
    loops = (here.rows.loop_slopes[..., 0], np.zeros(len(here.rows.loop_gaps)))
    motion = free(here.mass, here.mass @ v, loops)
    contacts = _touching(system, here.rows, touching, at_rest=True)
    impact = collide(motion, here.mass, contacts, system.restitution[touching])
    stays = contacts.Jn @ impact.v < escape
    still = stays & (np.abs(contacts.Jt @ impact.v) < escape) & (contacts.friction > 0)
    rows = np.concatenate([contacts.Jn[stays], contacts.Jt[still]])
    return impact, brought_to_rest(Free(impact.v, motion.P), rows)


def _touching(system: Unilateral, rows: Rows, some: NDArray[np.intp], *, at_rest: bool) -> Touching:
    """Some contacts, for velocities (``at_rest``: no bias) or for accelerations."""
    slips = rows.slips[some, 0]
    sliding = np.where(np.abs(slips) > STILL, np.sign(slips), 0.0)
    none = np.zeros(len(some))
    return Touching(
        rows.Jn[some, :, 0],
        rows.Jt[some, :, 0],
        none if at_rest else rows.normal_bias[some, 0],
        none if at_rest else rows.slip_bias[some, 0],
        system.friction[some],
        none if at_rest else sliding,
    )


def _choose(system: Unilateral, here: _Here, resting: NDArray[np.intp]) -> tuple[Touch, bool]:
    """The mode in which accelerations, forces and the laws agree."""
    doing = [OPEN] * len(system.names)
    loops = (here.rows.loop_slopes[..., 0], -here.rows.loop_bias[:, 0])
    motion = free(here.mass, here.applied, loops)
    contacts = _touching(system, here.rows, resting, at_rest=False)
    found = push(motion, contacts)
    if found.status is not LcpStatus.SOLVED:
        return Touch(tuple(doing)), False
    pushing, idle = _carrying(motion, contacts, found)
    for local in [*pushing, *idle]:
        contact = int(resting[local])
        if contact >= system.pairs:
            doing[contact] = CLOSED
        elif system.friction[contact] == 0:
            doing[contact] = FRICTIONLESS
        else:
            doing[contact] = _friction(contacts, found, int(local))
    stuck = [i for i in pushing if doing[resting[i]] == STICKING]
    rows = np.concatenate([contacts.Jn[pushing], contacts.Jt[stuck]])
    shared = len(rows) > 0 and _rank(motion, rows) < len(rows)
    return Touch(tuple(doing), frozenset(int(resting[i]) for i in idle), shared), True


def _friction(contacts: Touching, found: Pushes, local: int) -> str:
    if contacts.sliding[local]:
        return RIGHT if contacts.sliding[local] > 0 else LEFT
    if not found.slides[local]:
        return STICKING
    return LEFT if found.tangential[local] > 0 else RIGHT


def _carrying(
    motion: Free, contacts: Touching, found: Pushes
) -> tuple[NDArray[np.intp], list[int]]:
    """The closed contacts: independent ones that carry, and those that follow from them.

    Those with a force come first; one without a force and without acceleration is closed, too.
    """
    rates = contacts.Jn @ found.x + contacts.normal
    size = 1.0 + float(np.max(np.abs(motion.x), initial=0.0))
    closed = [*np.flatnonzero(found.normal > 0)]
    closed += [i for i in np.flatnonzero(rates < NONE * size) if i not in closed]
    carrying: list[int] = []
    for contact in closed:
        rows = contacts.Jn[[*carrying, contact]]
        if _rank(motion, rows) == len(rows):
            carrying.append(int(contact))
    idle = [int(contact) for contact in closed if contact not in carrying]
    return np.array(carrying, dtype=np.intp), idle


def _rank(motion: Free, rows: Array) -> int:
    return int(np.linalg.matrix_rank(rows @ motion.P @ rows.T, tol=None, hermitian=True))


def _projected(system: Unilateral, time: float, state: Array, touch: Touch) -> Array:
    """The state with gaps, their rates and slips of what touches made zero, and loops closed."""
    for _ in range(2):
        here = _look(system, time, state)
        n, rows, carrying = len(state) // 2, here.rows, touch.carrying
        P = np.asarray(np.linalg.inv(here.mass), dtype=np.float64)
        D = np.concatenate([rows.Jn[carrying, :, 0], rows.loop_slopes[..., 0]])
        open_by = np.concatenate([rows.gaps[carrying, 0], rows.loop_gaps[:, 0]])
        q = state[:n] - P @ D.T @ (np.linalg.pinv(D @ P @ D.T, rcond=DEPENDENT) @ open_by)
        still = np.concatenate([D, rows.Jt[touch.sticking, :, 0]])
        state = np.concatenate([q, brought_to_rest(Free(state[n:], P), still)])
    return state
