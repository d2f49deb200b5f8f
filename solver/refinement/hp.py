"""Segments of their own degree: raise it where the motion is smooth, cut where it is not."""

import numpy as np
from numpy.typing import NDArray

from schemas.problem import Refinement
from solver.refinement.meshed import Array, Meshed
from solver.refinement.subdivide import KAPPA, Counts, count_parts, largest_if_unknown

SMOOTH = 0.5 * np.log(10)
"""The least decay of a smooth segment: its coefficients fall tenfold every two degrees."""

FASTEST = 10.0
"""No decay counts as faster: a polynomial of low degree has no rate at all."""

ROUGH_POINTS = 4
"""The most points of a part of a segment that was cut because it is not smooth."""

LEAST_POINTS = 3
"""No segment loses more points than down to these."""


def hp(phase: Meshed, settings: Refinement) -> tuple[Counts, Counts]:
    """The parts of each segment, and the points of each of its parts; (segments,) both.

    Above the tolerance a smooth segment of error e and decay s gets ceil(log(e / (kappa *
    tolerance)) / s) more points, where that stays within ``settings.max_points``; every other
    one is cut as equation 8.22 says with the order of its degree (Liu, Hager and Rao, 2018;
    Patterson, Hager and Rao, 2015). With ``settings.merge`` a segment that would stay below a
    tenth of the tolerance with fewer points loses them, unless it has just been cut or raised.
    """
    points, rates = _known(phase)
    errors = largest_if_unknown(phase.errors)
    excess = np.log(np.maximum(errors, np.finfo(float).tiny) / (KAPPA * settings.tolerance))
    steady = np.clip(rates, SMOOTH, FASTEST)
    above = errors > settings.tolerance
    smooth = rates >= SMOOTH

    changed = points + np.ceil(excess / steady)
    raises = above & smooth & (changed <= settings.max_points)
    parts = np.where(raises, 1, count_parts(errors, phase.orders, settings))
    rough = above & ~smooth
    wanted = np.where(raises, changed, np.where(rough, np.minimum(points, ROUGH_POINTS), points))
    if settings.merge:
        spare = ~above & smooth & ~phase.fresh()
        lowered = np.clip(changed, np.minimum(LEAST_POINTS, points), points)
        wanted = np.where(spare, lowered, wanted)
    return parts, wanted.astype(int)


def _known(phase: Meshed) -> tuple[NDArray[np.int_], Array]:
    if phase.mesh.degrees is None or phase.rates is None:
        raise ValueError("A mesh without degrees, or without the decay of its curves, has no hp.")
    return phase.mesh.degrees, phase.rates
