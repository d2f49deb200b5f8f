"""Segment polynomials in powers of the local time, as the Chebyshev series that are published."""

import numpy as np
from numpy.typing import NDArray

from footfall.curves import fit

Array = NDArray[np.float64]


def from_powers(powers: Array) -> Array:
    """Chebyshev coefficients of polynomials given in 1, s, s^2, ... with s in [0, 1].

    Parameters
    ----------
    powers
        Coefficients of each power, shape (segments, degree + 1, series).

    Returns
    -------
    Shape (series, segments, degree + 1).
    """
    count = powers.shape[1]
    nodes = np.linspace(-1.0, 1.0, count)
    vandermonde = np.vander((nodes + 1) / 2, count, increasing=True)
    return fit(nodes, np.einsum("np,kpi->kni", vandermonde, powers))
