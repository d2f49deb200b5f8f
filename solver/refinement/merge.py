"""Where to join: neighbours that are needlessly fine."""

import numpy as np

from solver.refinement.meshed import Array, Flags, Meshed
from solver.refinement.subdivide import KAPPA, Counts, largest_if_unknown

LEAST = 4
"""Segments that a phase keeps."""

SEAM = 0.02
"""How far the controls of joined segments may be from one polynomial, relative to their range.

The mesh error sees the states alone: where the dynamics are simple it is small also where a
control jumps or a constraint becomes active.
"""

_SHARE_ORDER = 3
"""Of a segment's share of the integrals' error: over a whole phase it falls with the square."""


def joins(phase: Meshed, tolerance: float) -> Flags:
    """Which segments are joined to the one on their left, (segments,); pairs alone.

    A pair is joined where the error of the joined segment, which is larger by the ratio of the
    lengths to the power of the order, stays below a tenth of the tolerance: it would have to be
    off by a factor of ten to be cut again. So must its share of the integrals' error. Never where
    the knot between them is new.
    """
    joined = np.zeros(phase.mesh.segments, dtype=bool)
    if phase.seams is None:
        return joined
    predicted = joined_errors(phase)
    allowed = (predicted <= KAPPA * tolerance) & (phase.seams <= SEAM) & ~phase.fresh_knots()
    if phase.shares is not None:
        allowed &= _together(phase, phase.shares, _SHARE_ORDER) <= 2 * KAPPA
    room = phase.mesh.segments - LEAST
    taken = np.zeros(phase.mesh.segments, dtype=bool)
    for knot in np.argsort(predicted, kind="stable"):
        pair = slice(knot, knot + 2)
        if room > 0 and allowed[knot] and not taken[pair].any():
            taken[pair] = joined[knot + 1] = True
            room -= 1
    return joined


def joined_errors(phase: Meshed) -> Array:
    """The error to expect of each two neighbours as one segment, (segments - 1,)."""
    return _together(phase, largest_if_unknown(phase.errors), phase.orders)


def _together(phase: Meshed, errors: Array, orders: Counts | int) -> Array:
    """What becomes of errors that fall as the length to a power, (segments - 1,)."""
    lengths = np.diff(phase.mesh.knots)
    both, powers = lengths[:-1] + lengths[1:], np.broadcast_to(orders, errors.shape)
    return np.asarray(
        np.maximum(
            errors[:-1] * (both / lengths[:-1]) ** powers[:-1],
            errors[1:] * (both / lengths[1:]) ** powers[1:],
        )
    )
