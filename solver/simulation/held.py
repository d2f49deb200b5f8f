"""The smooth motion while some contacts stay in touch, and what they need for it.

Every held row asks ``D a + bias = 0``; its force acts along G. Where a contact slides, its normal
force brings the friction along, so that G and D differ.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.numeric.tape import Array
from solver.simulation.impulses import DEPENDENT
from solver.simulation.instant import Instant
from solver.simulation.unilateral import Rows, Unilateral

OPEN, STICKING, RIGHT, LEFT = "open", "sticking", "sliding_right", "sliding_left"
FRICTIONLESS, CLOSED = "frictionless", "closed"
SIGN = {RIGHT: 1.0, LEFT: -1.0}

RETURN = 1.0
"""1/s: how fast gaps and slips that round-off opens are closed again, by Baumgarte's method.

Faster returns make the integrator's steps shorter; what is left is taken away at every event.
"""


@dataclass(frozen=True, slots=True)
class Touch:
    """What every unilateral constraint does: the mode of a mechanism.

    Attributes
    ----------
    doing
        One word each, as in `schemas.mechanisms.Mode`, or ``open``; ``closed`` of limits.
    idle
        Touching ones that follow from the others, like a third point of a straight sole: they
        carry nothing.
    shared
        Whether frictions follow from each other: they are then shared out by the normal forces.
    """

    doing: tuple[str, ...]
    idle: frozenset[int] = frozenset()
    shared: bool = False

    @property
    def carrying(self) -> list[int]:
        """Those with a normal force."""
        return [i for i, word in enumerate(self.doing) if word != OPEN and i not in self.idle]

    @property
    def sticking(self) -> list[int]:
        """Those of them that stick."""
        return [i for i in self.carrying if self.doing[i] == STICKING]

    @property
    def sliding(self) -> list[int]:
        """Those of them that slide."""
        return [i for i in self.carrying if self.doing[i] in SIGN]


class Forces(NamedTuple):
    """Accelerations (n, N); forces of constraints (c, N) and of loops, all x, then all y.

    ``regular`` (N,) says how far from singular the held rows are.
    """

    accelerations: Array
    normal: Array
    tangential: Array
    loops: Array
    regular: Array


def held(system: Unilateral, touch: Touch, at: Instant, rows: Rows) -> Forces:
    """Solve for accelerations and forces at N points."""
    D, G, bias = _held_rows(system, touch, rows)
    force = at.applied
    right = np.concatenate([G.transpose(2, 1, 0), force.T[..., None]], axis=-1)
    both = np.linalg.solve(at.mass, right)
    toward, free = both[..., :-1], both[..., -1]
    compliance = D.transpose(2, 0, 1) @ toward
    asked = -np.einsum("rnN,Nn->Nr", D, free) - bias.T
    weights = np.ones((len(free), len(bias)))
    sizes = _solve(compliance, asked, weights, exact=not (touch.shared or len(rows.loop_gaps)))
    if touch.shared:
        _weigh(system, touch, sizes, weights)
        sizes = _solve(compliance, asked, weights, exact=False)
    accelerations = free + np.einsum("Nnr,Nr->Nn", toward, sizes)
    normal, tangential = _named(system, touch, sizes)
    loops = sizes[:, sizes.shape[1] - len(rows.loop_gaps) :].T
    regular = _regularity(touch, compliance, D, at)
    return Forces(accelerations.T, normal, tangential, loops, regular)


def _held_rows(system: Unilateral, touch: Touch, rows: Rows) -> tuple[Array, Array, Array]:
    """D and G (rows, n, N), and the bias (rows, N): normals, frictions, loops."""
    carrying, sticking = touch.carrying, touch.sticking
    drag = np.array([-SIGN.get(touch.doing[i], 0.0) * system.friction[i] for i in carrying])
    back = rows.normal_bias + 2 * RETURN * rows.rates + RETURN**2 * rows.gaps
    still = rows.slip_bias + RETURN * rows.slips
    closing = rows.loop_bias + 2 * RETURN * rows.loop_rates + RETURN**2 * rows.loop_gaps
    Jn, Jt = rows.Jn[carrying], rows.Jt[sticking]
    G = np.concatenate([Jn + drag[:, None, None] * rows.Jt[carrying], Jt, rows.loop_slopes])
    D = np.concatenate([Jn, Jt, rows.loop_slopes])
    return D, G, np.concatenate([back[carrying], still[sticking], closing])


def _solve(compliance: Array, asked: Array, weights: Array, *, exact: bool) -> Array:
    """Forces (N, rows); where rows depend on each other, the least by weight."""
    if exact:
        try:
            return np.asarray(np.linalg.solve(compliance, asked[..., None])[..., 0])
        except np.linalg.LinAlgError:  # singular at one point: the guard on regularity sees it
            pass
    scaled = compliance * weights[:, None]
    finite = np.where(np.isfinite(scaled), scaled, 0.0)
    found = np.linalg.pinv(finite, rcond=DEPENDENT) @ asked[..., None]
    return np.asarray(weights * found[..., 0])


def _weigh(system: Unilateral, touch: Touch, sizes: Array, weights: Array) -> None:
    """Weigh frictions so that equal rows share by what their cones hold.

    The sum of squares of ``t / sqrt(c)`` is least, for equal rows, at t in proportion to c.
    """
    carrying = touch.carrying
    for row, contact in enumerate(touch.sticking, len(carrying)):
        cone = system.friction[contact] * sizes[:, carrying.index(contact)]
        weights[:, row] = np.sqrt(np.maximum(cone, 1e-12 * np.abs(sizes).max() + 1e-300))


def _named(system: Unilateral, touch: Touch, sizes: Array) -> tuple[Array, Array]:
    """Normal and tangential forces of all constraints, (c, N)."""
    shape = (len(touch.doing), len(sizes))
    normal, tangential = np.zeros(shape), np.zeros(shape)
    carrying, sticking = touch.carrying, touch.sticking
    normal[carrying] = sizes[:, : len(carrying)].T
    tangential[sticking] = sizes[:, len(carrying) : len(carrying) + len(sticking)].T
    for contact in touch.sliding:
        drag = -SIGN[touch.doing[contact]] * system.friction[contact]
        tangential[contact] = drag * normal[contact]
    return normal, tangential


def _regularity(touch: Touch, compliance: Array, D: Array, at: Instant) -> Array:
    """The determinant of the held rows, 1 where friction couples nothing; below 0 is Painleve's.

    Over that of the same rows without the friction of those that slide.
    """
    if not touch.sliding or touch.shared:
        return np.ones(len(compliance))
    rows = D.transpose(2, 0, 1)
    plain = rows @ np.linalg.solve(at.mass, rows.transpose(0, 2, 1))
    sign, size = np.linalg.slogdet(compliance)
    other, scale = np.linalg.slogdet(plain)
    return np.where(other > 0, sign * np.exp(np.minimum(size - scale, 50.0)), 1.0)
