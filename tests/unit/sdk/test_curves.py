"""Curves are evaluated as numpy evaluates each segment on its own."""

from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Chebyshev, Polynomial

from footfall.curves import Curve, Curves, OutsideDomain, fit

BREAKS = np.array([0.0, 0.5, 0.8, 2.0])
ROWS = np.random.default_rng(1).normal(size=(3, 5))


@pytest.fixture
def curve() -> Curve:
    return Curve(BREAKS, ROWS)


def segment(index: int) -> Chebyshev:
    return Chebyshev(ROWS[index], domain=BREAKS[index : index + 2])


def test_values_match_numpy_segment_by_segment(curve: Curve) -> None:
    times = np.linspace(0.0, 2.0, 41)
    expected = [segment(min(np.searchsorted(BREAKS, t, "right") - 1, 2))(t) for t in times]
    np.testing.assert_allclose(curve(times), expected, rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_match_numpy(curve: Curve, order: int) -> None:
    for index, middle in enumerate((BREAKS[1:] + BREAKS[:-1]) / 2):
        assert curve.derivative(order)(middle) == pytest.approx(segment(index).deriv(order)(middle))


def test_a_derivative_beyond_the_degree_is_zero() -> None:
    assert Curve([0, 1], [[2.0, 1.0]]).derivative(2)(0.3) == 0.0


def test_a_jump_takes_the_right_side_unless_told(curve: Curve) -> None:
    assert curve(0.5) == pytest.approx(segment(1)(0.5))
    assert curve(0.5, side="left") == pytest.approx(segment(0)(0.5))
    assert curve(2.0) == pytest.approx(segment(2)(2.0))
    assert curve(0.0, side="left") == pytest.approx(segment(0)(0.0))


def test_the_shape_of_the_times_is_kept(curve: Curve) -> None:
    assert np.shape(curve(1.0)) == ()
    assert curve(np.ones((2, 3))).shape == (2, 3)
    assert curve([]).shape == (0,)


@pytest.mark.parametrize("time", [-0.1, 2.1, np.nan])
def test_a_time_outside_is_named(curve: Curve, time: float) -> None:
    with pytest.raises(OutsideDomain, match=r"outside of the curve's \[0, 2\] s"):
        curve([1.0, time])


def test_a_time_outside_by_rounding_is_the_end(curve: Curve) -> None:
    assert curve(2.0 + 1e-15) == curve(2.0)


def test_a_segment_of_no_width_is_harmless() -> None:
    curve = Curve([0, 0, 1], [[5.0, 0.0], [1.0, 1.0]])
    assert curve(0.0) == 0.0
    assert np.all(np.isfinite(curve.derivative()([0.0, 1.0])))


def test_nodes_hold_both_ends_of_each_segment(curve: Curve) -> None:
    nodes = curve.nodes(5)
    assert nodes.shape == (3, 5)
    np.testing.assert_allclose(nodes[:, 0], BREAKS[:-1])
    np.testing.assert_allclose(nodes[:, -1], BREAKS[1:])


def test_fit_reproduces_polynomials_exactly() -> None:
    nodes = np.array([-1.0, -0.2, 0.4, 1.0])
    cubics = [
        [Polynomial([1, 2, -1, 3]), Polynomial([0, 0, 1])],
        [Polynomial([4]), Polynomial([0, 1, 0, -2])],
    ]
    values = np.array([[[series(s) for series in row] for s in nodes] for row in cubics])
    curves = Curves.through(["a", "b"], [0.0, 2.0, 4.0], nodes, values)
    inner = np.linspace(-1, 1, 7)
    for index, row in enumerate(cubics):
        for name, series in zip("ab", row, strict=True):
            np.testing.assert_allclose(
                curves[name](1 + 2 * index + 0.999999 * inner), series(0.999999 * inner), atol=1e-12
            )


def test_curves_travel_as_json() -> None:
    curves = Curves(BREAKS, {"x": ROWS, "v": ROWS[:, :3]})
    again = Curves.from_dict(curves.to_dict())
    times = np.linspace(0, 2, 9)
    assert list(again) == ["x", "v"]
    for name, values in curves.sample(times).items():
        np.testing.assert_array_equal(again.sample(times)[name], values)


@pytest.mark.parametrize(
    ("breaks", "rows", "message"),
    [
        ([0.0], [[1.0]], "two breaks"),
        ([0.0, 1.0], [[1.0], [2.0]], r"shape \(1, degree \+ 1\)"),
        ([0.0, 1.0], [1.0], r"got \(1,\)"),
        ([1.0, 0.0], [[1.0]], "never decrease"),
        ([0.0, np.nan], [[1.0]], "never decrease"),
    ],
)
def test_what_does_not_fit_is_refused(breaks: list[float], rows: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Curve(breaks, rows)


def test_fit_refuses_what_does_not_fit() -> None:
    with pytest.raises(ValueError, match=r"\(segments, 2, series\)"):
        fit([-1.0, 1.0], np.zeros((3, 4, 1)))
    with pytest.raises(ValueError, match="distinct"):
        fit([1.0, 1.0], np.zeros((3, 2, 1)))


def test_what_is_no_number_is_null_in_json_and_nan_again() -> None:
    curves = Curves([0, 1, 2], {"x": [[1.0, 2.0], [np.nan, np.inf]]})
    document = curves.to_dict()
    assert document["coefficients"] == {"x": [[1.0, 2.0], [None, None]]}
    assert np.isnan(Curves.from_dict(document)["x"](1.5))
