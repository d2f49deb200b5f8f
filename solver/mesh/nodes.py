"""Nodes of orthogonal collocation on [0, 1], and the matrices that belong to them (003, 7.14)."""

from functools import cache

import numpy as np
from numpy.polynomial import chebyshev, legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]


@cache
def chebyshev_lobatto(degree: int) -> tuple[float, ...]:
    """The Chebyshev points of the second kind, degree + 1 of them, ends included (7.72)."""
    return tuple((1.0 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2.0)


@cache
def legendre_radau(points: int) -> tuple[float, ...]:
    """The flipped Legendre-Gauss-Radau points: the end is one of them, the start is not.

    They are the mirrored roots of P_n + P_(n-1).
    """
    series = np.zeros(points + 1)
    series[-2:] = 1.0
    inner = np.sort(1.0 - legendre.legroots(series).real)[:-1] / 2.0
    return (*inner.tolist(), 1.0)  # exactly: it is the knot


def differentiation_matrix(nodes: Array) -> Array:
    """D with f' = D f for the polynomial through values at the nodes; shape (n, n)."""
    basis = chebyshev.chebvander(2 * nodes - 1, len(nodes) - 1)
    slopes = chebyshev.chebvander(2 * nodes - 1, max(len(nodes) - 2, 0))
    derivative = chebyshev.chebder(np.eye(len(nodes)), axis=0) * 2.0
    return np.asarray(slopes @ derivative @ np.linalg.inv(basis))


def quadrature_weights(nodes: Array) -> Array:
    """Weights that integrate the polynomial through values at the nodes over [0, 1], exactly."""
    basis = chebyshev.chebvander(2 * nodes - 1, len(nodes) - 1)
    whole = chebyshev.chebint(np.eye(len(nodes)), lbnd=-1, axis=0) / 2.0
    integrals = chebyshev.chebval(1.0, whole)
    return np.asarray(np.linalg.solve(basis.T, integrals))


def interpolation_row(nodes: Array, at: float) -> Array:
    """Weights that give the value at one place of the polynomial through the nodes."""
    basis = chebyshev.chebvander(2 * nodes - 1, len(nodes) - 1)
    row = chebyshev.chebvander(np.array([2 * at - 1]), len(nodes) - 1)[0]
    return np.asarray(np.linalg.solve(basis.T, row))
