"""Where to cut: the order-based number of parts of each segment (003, equation 8.22)."""

import numpy as np
from numpy.typing import NDArray

from schemas.problem import Refinement

Array = NDArray[np.float64]
Counts = NDArray[np.int_]

KAPPA = 0.1
"""The safety factor of 8.22: aim at a tenth of the tolerance."""


def count_parts(errors: Array, order: int | Counts, settings: Refinement) -> Counts:
    """The number of parts of each segment, one where the error is within the tolerance.

    A segment of error e gets ceil((e / (kappa * tolerance))^(1 / order)) parts, two at the least
    and ``settings.max_subdivisions`` at the most; an error that is not a number counts as the
    largest. ``order`` is one number, or one for each segment.
    """
    certain = largest_if_unknown(errors)
    wanted = np.ceil((certain / (KAPPA * settings.tolerance)) ** (1.0 / order))
    parts = np.clip(wanted, 2, settings.max_subdivisions).astype(int)
    return np.where(certain > settings.tolerance, parts, 1)


def keep_to(room: int, parts: Counts, errors: Array) -> Counts:
    """Parts that add ``room`` segments at the most: else the worst are halved, as many as fit."""
    if np.sum(parts - 1) <= room:
        return parts
    cut = np.flatnonzero(parts > 1)
    worst = cut[np.argsort(-largest_if_unknown(errors)[cut], kind="stable")]
    halved = np.ones_like(parts)
    halved[worst[: max(room, 0)]] = 2
    return halved


def largest_if_unknown(errors: Array) -> Array:
    """The errors with infinity in place of what is not a number."""
    return np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
