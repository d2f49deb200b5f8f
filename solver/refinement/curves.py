"""What the published curves say about smoothness: along a segment, and from one to the next."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curve, Curves, locate
from schemas.results import PhaseResult

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_FLOOR = 1e-14  # relative: below it is round-off
_FLAT = 1e-5  # the same: a control of a smaller range rests, but for what the solver leaves
_TIMES = 3.0  # of it a jump of a cubic's second derivative counts for two thirds
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
    return _at_knots(result, _continued)


def bends(result: PhaseResult) -> Array:
    """The same, but over the shorter of both pieces only: how far a control bends in a segment.

    A kink bends it by less on shorter segments, a jump does not. Continued beyond its piece, a
    polynomial of degree 8 multiplies by 1e5 what the NLP solver has left of a control at rest, and
    every segment of an arc seems to bend. So no more counts than some times what one polynomial,
    of the higher of both degrees, leaves over of the shorter piece and as much of the other, in
    units of what it leaves of a kink.
    """
    return _at_knots(result, _bend)


def _at_knots(result: PhaseResult, measure: Callable[[Curve, Index, Index], Array]) -> Array:
    """The largest ``measure`` of a series' pieces on the left and on the right of each knot."""
    inner = np.array(result.knots[1:-1])
    worst = np.zeros(len(inner))
    if not len(inner):
        return worst
    groups = [result.curves[label] for label in ("controls", "rates") if label in result.curves]
    for curves in (Curves.from_dict(group.model_dump()) for group in groups):
        left, _ = locate(curves.breaks, inner, side="left")
        right, _ = locate(curves.breaks, inner, side="right")
        for curve in curves.values():
            values = curve.coefficients @ chebyshev.chebvander(_PLACES, curve.degree).T
            span = max(float(np.ptp(values)), _FLAT * (1 + float(np.max(np.abs(values)))))
            worst = np.maximum(worst, measure(curve, left, right) / span)
    return worst


def _continued(curve: Curve, left: Index, right: Index) -> Array:
    """How far each piece, continued over the other one, is from it."""
    widths = np.diff(curve.breaks)
    return _apart(curve, left, right, (widths[right], -widths[left]))


def _bend(curve: Curve, left: Index, right: Index) -> Array:
    """How far the pieces bend at their knot, as ``bends`` says."""
    widths = np.diff(curve.breaks)
    reach = np.minimum(widths[left], widths[right])
    continued = _apart(curve, left, right, (reach, -reach))
    return np.minimum(continued, _TIMES * _left_over(curve, left, right, reach))


def _apart(curve: Curve, left: Index, right: Index, spreads: tuple[Array, Array]) -> Array:
    """The larger distance of pieces, ``spreads`` seconds ahead and back of their knot."""
    return np.maximum(*(_difference(curve, left, right, spread) for spread in spreads))


def _left_over(curve: Curve, left: Index, right: Index, reach: Array) -> Array:
    """What one polynomial leaves of both pieces, as far as ``reach`` from their knot."""
    knots = curve.breaks[right]
    own = curve.degree - np.argmax((curve.coefficients != 0)[:, ::-1], axis=1)
    degrees = np.maximum(own[left], own[right])
    rest = np.zeros(len(knots))
    for degree in np.unique(degrees):
        here = degrees == degree
        places, leave = _one_polynomial(max(int(degree), 1))
        spread = places[:, None] * reach[here]
        before = _at(curve, left[here], knots[here] - spread)
        after = _at(curve, right[here], knots[here] + spread)
        rest[here] = np.max(np.abs(leave @ np.concatenate([before, after])), axis=0)
    return rest


@cache
def _one_polynomial(degree: int) -> tuple[Array, Array]:
    """Distances from a knot in (0, 1), and what least squares leave of values there on both sides.

    The matrix (2 n, 2 n) takes the n values before the knot, then those after it; it leaves 1 of
    the largest of a kink of slope 1.
    """
    places = (chebyshev.chebpts1(2 * degree + 2) + 1) / 2
    basis = chebyshev.chebvander(np.concatenate([-places, places]), degree)
    q = np.linalg.qr(basis)[0]
    leave = np.eye(len(q)) - q @ q.T
    kink = np.concatenate([np.zeros_like(places), places])
    return places, leave / np.max(np.abs(leave @ kink))


def _difference(curve: Curve, left: Index, right: Index, spread: Array) -> Array:
    """How far pieces are apart between their common knot and ``spread`` seconds from it."""
    times = curve.breaks[right] + spread * (_PLACES[:, None] + 1) / 2
    return np.asarray(np.max(np.abs(_at(curve, left, times) - _at(curve, right, times)), axis=0))


def _at(curve: Curve, piece: Index, times: Array) -> Array:
    """Each piece's polynomial, continued, at times (places, pieces)."""
    starts, widths = curve.breaks[:-1], np.diff(curve.breaks)
    rows = np.moveaxis(curve.coefficients, -1, 0)
    s = 2 * (times - starts[piece]) / widths[piece] - 1
    return np.asarray(chebyshev.chebval(s, rows[:, piece], tensor=False))
