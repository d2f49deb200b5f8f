"""The quadrature is exact for polynomials, finds kinks, and knows when it fails."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from solver.lowering import lower
from solver.numeric import PhaseCurves, Samples, gauss, integrate
from tests.support.exact import block_problem, block_result


def block(segments: int = 3) -> PhaseCurves:
    return PhaseCurves.read(lower(block_problem())[0], block_result(segments))


@pytest.mark.parametrize("panels", [1, 2, 5])
@pytest.mark.parametrize("points", [2, 5, 10])
def test_gauss_is_exact_to_its_degree(points: int, panels: int) -> None:
    nodes, weights = gauss(points, panels)
    for degree in range(2 * points):
        exact = (1 - (-1.0) ** (degree + 1)) / (degree + 1)
        assert nodes**degree @ weights == pytest.approx(exact, abs=1e-14)


def test_rows_are_integrated_over_the_true_curves() -> None:
    integral = integrate(block(), lambda at: np.stack([at.u[0] ** 2, at.x[0] ** 6, at.t**9]))
    sixth = np.polynomial.Polynomial([0, 0, 3, -2]) ** 6
    assert integral.value == pytest.approx([12, sixth.integ()(1), 0.1], rel=1e-14)
    assert np.all(integral.error < 1e-13)


@pytest.mark.parametrize(
    ("integrand", "exact"),
    [
        (lambda at: np.abs(at.u), 3.0),
        (lambda at: np.sign(at.t - 1 / math.e)[None], 1 - 2 / math.e),
        (lambda at: np.sqrt(at.t)[None], 2 / 3),
    ],
)
def test_kinks_and_jumps_inside_a_segment(
    integrand: Callable[[Samples], np.ndarray], exact: float
) -> None:
    integral = integrate(block(1), integrand)
    assert integral.value[0] == pytest.approx(exact, abs=1e-10)
    assert integral.error[0] < 1e-9


def test_what_has_no_value_is_nan() -> None:
    with np.errstate(invalid="ignore"):
        integral = integrate(block(), lambda at: np.sqrt(0.5 - at.x))
    assert np.isnan(integral.value[0])


def test_noise_is_owned_up_to() -> None:
    noise = np.random.default_rng(1)

    def integrand(at: Samples) -> np.ndarray:
        return noise.standard_normal((1, len(at.t)))

    assert integrate(block(), integrand).error[0] > 1e-3


def test_no_rows() -> None:
    assert integrate(block(), lambda at: np.empty((0, len(at.t)))).value.shape == (0,)
