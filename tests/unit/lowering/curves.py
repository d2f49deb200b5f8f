"""Smooth curves through values at Chebyshev points, differentiated nearly to round-off."""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Chebyshev

Function = Callable[[np.ndarray], np.ndarray]

HALF = 0.1
DEGREE = 20


def times(middle: float) -> np.ndarray:
    """The points of a window around ``middle``."""
    return middle + HALF * np.polynomial.chebyshev.chebpts2(DEGREE + 1)


def rate(values: np.ndarray) -> np.ndarray:
    """The derivative, at the same points, of what has ``values`` at the points of a window."""
    points = np.polynomial.chebyshev.chebpts2(DEGREE + 1)
    fit = np.polynomial.chebyshev.chebfit(points, values, DEGREE)
    return Chebyshev(fit).deriv()(points) / HALF
