"""What the published curves say about smoothness: along a segment, and from one to the next."""

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curve, Curves, locate
from schemas.results import PhaseResult

Array = NDArray[np.float64]

_FLOOR = 1e-14  # relative: below it is round-off
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
    """How far the controls of neighbouring segments are from one polynomial.

    At each inner knot the piece on its left is continued over the piece on its right and the
    other way round; the largest difference counts, relative to the control's range on the phase.

    Returns
    -------
    Shape (segments - 1,) for the inner knots of ``result.knots``; zero without controls.
    """
    inner = np.array(result.knots[1:-1])
    worst = np.zeros(len(inner))
    group = result.curves.get("controls")
    if group is None or not group.coefficients or not len(inner):
        return worst
    curves = Curves.from_dict(group.model_dump())
    left, _ = locate(curves.breaks, inner, side="left")
    right, _ = locate(curves.breaks, inner, side="right")
    for curve in curves.values():
        values = curve.coefficients @ chebyshev.chebvander(_PLACES, curve.degree).T
        span = float(np.ptp(values))
        if span > _FLOOR * (1 + np.max(np.abs(values))):
            apart = np.maximum(_beyond(curve, left, right), _beyond(curve, right, left))
            worst = np.maximum(worst, apart / span)
    return worst


def _beyond(curve: Curve, of: NDArray[np.intp], over: NDArray[np.intp]) -> Array:
    """How far pieces ``of`` are from pieces ``over``, on the spans of the latter."""
    starts, widths = curve.breaks[:-1], np.diff(curve.breaks)
    times = starts[over] + widths[over] * (_PLACES[:, None] + 1) / 2
    s = 2 * (times - starts[of]) / widths[of] - 1
    rows = np.moveaxis(curve.coefficients, -1, 0)
    continued = chebyshev.chebval(s, rows[:, of], tensor=False)
    own = chebyshev.chebval(np.broadcast_to(_PLACES[:, None], s.shape), rows[:, over], tensor=False)
    return np.asarray(np.max(np.abs(continued - own), axis=0))
