"""Segment polynomials in powers of the local time, as the Chebyshev series that are published."""

import math

import numpy as np
from numpy.typing import NDArray

from footfall.curves import fit

Array = NDArray[np.float64]


def corners(nodes: Array) -> Array:
    """The Bernstein coefficients on [0, 1] of the polynomial through values at the nodes.

    A polynomial lies within the range of its Bernstein coefficients; the first and the last are
    its values at the ends.

    Parameters
    ----------
    nodes
        Places in [0, 1], shape (n,).

    Returns
    -------
    Shape (n, n), to be multiplied by the values.
    """
    degree = len(nodes) - 1
    which = np.arange(degree + 1)
    count = np.array([math.comb(degree, one) for one in which], dtype=float)
    basis = count * nodes[:, None] ** which * (1 - nodes[:, None]) ** which[::-1]
    return np.asarray(np.linalg.inv(basis))


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
