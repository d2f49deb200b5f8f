"""Numbers of frames, as JSON takes them."""

import math

import numpy as np

from schemas.frames import Numbers
from solver.numeric.tape import Array

_DIGITS = 6  # after the point: micrometres are enough to draw


def listed(values: Array) -> Numbers:
    """Numbers for JSON, rounded; null where there is none."""
    return [value if math.isfinite(value) else None for value in np.round(values, _DIGITS).tolist()]
