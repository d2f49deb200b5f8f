"""Nodes, differentiation matrices and weights of orthogonal collocation."""

import numpy as np
import pytest

from solver.mesh.nodes import (
    chebyshev_lobatto,
    differentiation_matrix,
    interpolation_row,
    legendre_radau,
    quadrature_weights,
)


@pytest.mark.parametrize("points", [1, 2, 3, 5, 9, 20])
def test_radau_integrates_twice_its_number_of_points(points: int) -> None:
    nodes = np.array(legendre_radau(points))
    weights = quadrature_weights(nodes)
    assert nodes[-1] == pytest.approx(1.0, abs=1e-12)
    assert np.all((nodes > 0) & (weights > 0))
    for power in range(2 * points - 1):
        assert weights @ nodes**power == pytest.approx(1 / (power + 1), rel=1e-9)


def test_radau_of_three_points() -> None:
    root = np.sqrt(6)
    np.testing.assert_allclose(legendre_radau(3), [(4 - root) / 10, (4 + root) / 10, 1])


@pytest.mark.parametrize("degree", [1, 2, 7, 24, 60])
def test_chebyshev_differentiates_and_integrates(degree: int) -> None:
    nodes = np.array(chebyshev_lobatto(degree))
    values, slopes = np.cos(3 * nodes), -3 * np.sin(3 * nodes)
    if degree >= 24:
        np.testing.assert_allclose(differentiation_matrix(nodes) @ values, slopes, atol=1e-9)
        assert quadrature_weights(nodes) @ values == pytest.approx(np.sin(3) / 3, abs=1e-13)
    polynomial = np.polynomial.Polynomial(np.arange(1.0, min(degree, 8) + 2))
    np.testing.assert_allclose(
        differentiation_matrix(nodes) @ polynomial(nodes), polynomial.deriv()(nodes), rtol=1e-8
    )


def test_interpolation_is_exact_for_polynomials() -> None:
    nodes = np.array(legendre_radau(4))
    assert interpolation_row(nodes, 0.0) @ (1 + nodes**3) == pytest.approx(1)
