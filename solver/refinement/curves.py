"""What the published curves say about smoothness: along a segment, and from one to the next."""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curve, Curves, locate
from schemas.results import PhaseResult

Array = NDArray[np.float64]

_FLOOR = 1e-14  # relative: below it is round-off
_FLAT = 1e-5  # the same: a control of a smaller range rests, but for what the solver leaves
_PLACES = np.linspace(-1.0, 1.0, 9)


def decay(result: PhaseResult, degrees: NDArray[np.int_]) -> Array:
    """How fast the Chebyshev coefficients of the states fall on each segment.

    The rate s of c_k ~ exp(-s k), fitted to the logarithm of the envelope of the coefficients of
    degree 1 and higher; each state is taken relative to 1 + max abs(x), and the largest counts
    (after Liu, Hager and Rao, 2018, who fit Legendre coefficients). A kink gives about 2 ln(n) / n.

    Parameters
    ----------
    result
        Its states have one piece on each segment.
    degrees
        The degree of the states on each segment, (segments,).

    Returns
    -------
    Shape (segments,). Infinite where there is nothing but round-off above degree 1.
    """
    curves = Curves.from_dict(result.curves["states"].model_dump())
    rows = [np.abs(curve.coefficients) / (1 + _largest(curve)) for curve in curves.values()]
    table = np.max(np.array(rows), axis=0)
    return np.array([_rate(row[: n + 1]) for row, n in zip(table, degrees, strict=True)])


def _largest(curve: Curve) -> float:
    basis = chebyshev.chebvander(_PLACES, curve.degree)
    return float(np.max(np.abs(curve.coefficients @ basis.T)))


def _rate(sizes: Array) -> float:
    """The slope of the logarithm of the envelope of coefficients 1, 2, ..."""
    envelope = np.maximum.accumulate(sizes[:0:-1])[::-1]
    heard = envelope[envelope > _FLOOR]
    if len(heard) < 2:
        return np.inf if len(sizes) > 2 else 0.0
    return -float(np.polyfit(np.arange(len(heard)), np.log(heard), 1)[0])


def seams(result: PhaseResult) -> Array:
    """How far the controls of neighbouring segments, and their rates, are from one polynomial.

    At each inner knot the piece on its left is continued over the piece on its right and the
    other way round; the largest difference counts, relative to the series' range on the phase.

    Returns
    -------
    Shape (segments - 1,) for the inner knots of ``result.knots``; zero without controls.
    """
    return _apart(result, lambda left, right: (right, left))


def bends(result: PhaseResult) -> Array:
    """The same, but over the shorter of both pieces only: how far a control bends in a segment.

    A kink bends it by less on shorter segments, a jump does not.
    """
    return _apart(result, lambda left, right: (np.minimum(left, right),) * 2)


def _apart(result: PhaseResult, reach: Callable[[Array, Array], tuple[Array, Array]]) -> Array:
    """Over how far to continue on the right and on the left, ``reach`` says by their lengths."""
    inner = np.array(result.knots[1:-1])
    worst = np.zeros(len(inner))
    if not len(inner):
        return worst
    groups = [result.curves[label] for label in ("controls", "rates") if label in result.curves]
    for curves in (Curves.from_dict(group.model_dump()) for group in groups):
        left, _ = locate(curves.breaks, inner, side="left")
        right, _ = locate(curves.breaks, inner, side="right")
        widths = np.diff(curves.breaks)
        ahead, back = reach(widths[left], widths[right])
        for curve in curves.values():
            values = curve.coefficients @ chebyshev.chebvander(_PLACES, curve.degree).T
            span = max(float(np.ptp(values)), _FLAT * (1 + float(np.max(np.abs(values)))))
            for spread in (ahead, -back):
                worst = np.maximum(worst, _difference(curve, left, right, spread) / span)
    return worst


def _difference(
    curve: Curve, left: NDArray[np.intp], right: NDArray[np.intp], spread: Array
) -> Array:
    """How far pieces are apart between their common knot and ``spread`` seconds from it."""
    times = curve.breaks[right] + spread * (_PLACES[:, None] + 1) / 2
    return np.asarray(np.max(np.abs(_at(curve, left, times) - _at(curve, right, times)), axis=0))


def _at(curve: Curve, piece: NDArray[np.intp], times: Array) -> Array:
    """Each piece's polynomial, continued, at times (places, pieces)."""
    starts, widths = curve.breaks[:-1], np.diff(curve.breaks)
    rows = np.moveaxis(curve.coefficients, -1, 0)
    s = 2 * (times - starts[piece]) / widths[piece] - 1
    return np.asarray(chebyshev.chebval(s, rows[:, piece], tensor=False))
