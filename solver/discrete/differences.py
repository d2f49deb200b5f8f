"""Differences of functions over a step, divided by the step, without dividing by nothing.

Near 0 a series takes the place of each quotient; the other branch is kept away from 0, so that
neither it nor its derivatives are ever infinite.
"""

import math
from collections.abc import Callable, Sequence

import casadi as ca

from solver.expressions import FUNCTIONS, SX

_NEAR = 0.05
"""Where series take over. Their first neglected terms are below round-off there."""

_SMALL = 1e-7
"""The square of what is small for a sine: the fifth power is below round-off."""

_SINHC = [1 / math.factorial(2 * k + 1) for k in range(5)]
_ATANHC = [1 / (2 * k + 1) for k in range(6)]
_TANHC = [1, -1 / 3, 2 / 15, -17 / 315, 62 / 2835, -1382 / 155925]

_TURN = [2**k * math.factorial(k) ** 2 / math.factorial(2 * k + 1) for k in range(6)]
_WIDE = 1.85

_TINY = 1e-8
"""The square of a step below which Gonzalez's correction fades."""

_GAUSS = [(0.5 - math.sqrt(0.15), 5 / 18), (0.5, 8 / 18), (0.5 + math.sqrt(0.15), 5 / 18)]


def _series(squared: SX, coefficients: Sequence[float]) -> SX:
    total = SX(coefficients[-1])
    for one in reversed(coefficients[:-1]):
        total = total * squared + one
    return total


def _even(x: SX, far: Callable[[SX], SX], series: Sequence[float]) -> SX:
    """An even function: a series in ``x^2`` near 0; ``far`` is told an x that never is."""
    small = x * x < _NEAR**2
    safe = ca.if_else(small, 0.5, x)
    return SX(ca.if_else(small, _series(x * x, series), far(safe)))


def sinc(x: SX, sine: SX) -> SX:
    """``sin(x) / x``, the sine being known.

    Without branches, since it is in every row and differentiated twice: below the limit, where
    ``sin(x) = x - x^3/6`` to round-off, ``1 - x^2/6`` is added above and 1 below the line, so
    that ``(1 + x) (1 - x^2/6) / (1 + x)`` is left.
    """
    squared = x * x
    small = squared < _SMALL
    return SX((sine + small * (1 - squared / 6)) / (x + small))


def sinhc(x: SX) -> SX:
    """``sinh(x) / x``."""
    return _even(x, lambda safe: ca.sinh(safe) / safe, _SINHC)


def tanhc(x: SX) -> SX:
    """``tanh(x) / x``."""
    return _even(x, lambda safe: ca.tanh(safe) / safe, _TANHC)


def atanhc(x: SX) -> SX:
    """``atanh(x) / x``, for x between -1 and 1."""
    return _even(x, lambda safe: ca.atanh(safe) / safe, _ATANHC)


def turn_over_cross(cross: SX, along: SX) -> SX:
    """``atan2(cross, along) / cross``: of an angle between two vectors, by their products."""
    size = ca.sqrt(cross * cross + along * along)
    sine = cross / size
    squared = sine * sine
    small = (squared < _SMALL) * (along > 0)  # as in ``sinc``, for asin(x) / x
    return SX((ca.atan2(cross, along) + small * (1 + squared / 6)) / ((sine + small) * size))


def angle_over_sine(versine: SX) -> SX:
    """``a / sin(a)`` from ``1 - cos(a)``, for an angle from 0 on; above 2.6 rad as there."""
    small = versine < _NEAR**2
    u = ca.if_else(small, 0.5, ca.fmin(versine, _WIDE))
    far = ca.acos(1 - u) / ca.sqrt(u * (2 - u))
    return SX(ca.if_else(small, _series(versine, _TURN), far))


def corrected(function: str, before: SX, after: SX) -> SX:
    """Any function's mean slope by Gauss's rule, with the correction of Gonzalez (1996)."""
    x = SX.sym("x")
    slope = ca.gradient(FUNCTIONS[function](x), x)
    step = after - before
    mean = sum(
        (weight * ca.substitute(slope, x, before + place * step) for place, weight in _GAUSS), SX(0)
    )
    lacking = FUNCTIONS[function](after) - FUNCTIONS[function](before) - mean * step
    return SX(mean + lacking * step / (step * step + _TINY))
