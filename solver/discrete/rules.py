"""The rules of slope arithmetic: for every function, factors that give its exact change."""

import functools
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import casadi as ca

from solver.discrete import differences
from solver.discrete.chord import Arithmetic, Chord
from solver.expressions import FUNCTIONS, SX

Rule = Callable[[Arithmetic, Sequence[Chord]], Chord]

_FAINT = 1e-12
"""Keeps the slope of ``abs`` finite where its argument stays at 0."""


def _sum(make: Arithmetic, terms: Sequence[Chord]) -> Chord:
    before, after = (
        sum((getattr(one, side) for one in terms), SX(0)) for side in ("before", "after")
    )
    return make.made(before, after, [(one, SX(1)) for one in terms])


def _difference(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    a, b = arguments
    return make.made(a.before - b.before, a.after - b.after, [(a, SX(1)), (b, SX(-1))])


def _negative(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    (a,) = arguments
    return make.made(-a.before, -a.after, [(a, SX(-1))], -a.mean)


def _product(make: Arithmetic, factors: Sequence[Chord]) -> Chord:
    ordered = sorted(factors, key=lambda one: one.varies)  # numbers are multiplied first
    return functools.reduce(lambda a, b: _times(make, a, b), ordered)


def _times(make: Arithmetic, a: Chord, b: Chord) -> Chord:
    """``a1 b1 - a0 b0 = mean(a) (b1 - b0) + mean(b) (a1 - a0)``."""
    if a.place == b.place and a.varies:
        return make.made(a.before * a.before, a.after * a.after, [(a, a.before + a.after)])
    before, after = a.before * b.before, a.after * b.after
    mean = None if a.varies and b.varies else a.mean * b.mean
    return make.made(before, after, [(a, b.mean), (b, a.mean)], mean)


def _quotient(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """Of ``a = f b``: ``f1 - f0 = (a1 - a0 - mean(f) (b1 - b0)) / mean(b)``."""
    a, b = arguments
    before, after = a.before / b.before, a.after / b.after
    mean = 0.5 * (before + after) if b.varies else a.mean / b.mean
    return make.made(before, after, [(a, 1 / b.mean), (b, -mean / b.mean)], mean)


def _power(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    base, exponent = arguments
    if exponent.varies or not exponent.after.is_constant():
        return _exp(make, [_times(make, exponent, _log(make, [base]))])
    size = float(exponent.after)
    if size == int(size):
        return _whole_power(make, base, int(size))
    if 2 * size == int(2 * size):
        return _whole_power(make, _sqrt(make, [base]), int(2 * size))
    return _exp(make, [_times(make, exponent, _log(make, [base]))])


def _whole_power(make: Arithmetic, base: Chord, exponent: int) -> Chord:
    """By squares."""
    if exponent < 0:
        one = make.constant(SX(1))
        return _quotient(make, [one, _whole_power(make, base, -exponent)])
    if exponent < 2:
        return base if exponent else make.constant(SX(1))
    half = _whole_power(make, base, exponent // 2)
    whole = _times(make, half, half)
    return _times(make, whole, base) if exponent % 2 else whole


def _sqrt(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """Of ``f^2 = a``: ``f1 - f0 = (a1 - a0) / (f0 + f1)``."""
    (a,) = arguments
    before, after = ca.sqrt(a.before), ca.sqrt(a.after)
    return make.made(before, after, [(a, 1 / (before + after))])


def _hypot(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    a, b = arguments
    return _sqrt(make, [_sum(make, [_times(make, a, a), _times(make, b, b)])])


def _cos(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return make.turn(arguments[0])[0]


def _sin(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return make.turn(arguments[0])[1]


def _tan(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return _quotient(make, make.turn(arguments[0])[::-1])


def _exp(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """``exp(mean) sinh(d/2) / (d/2)``."""
    (a,) = arguments
    slope = ca.exp(a.mean) * differences.sinhc(0.5 * (a.after - a.before))
    return make.made(ca.exp(a.before), ca.exp(a.after), [(a, slope)])


def _log(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """``log(a1/a0) = 2 atanh(u)`` with ``u = (a1 - a0) / (a0 + a1)``."""
    (a,) = arguments
    if not a.varies:
        return make.constant(ca.log(a.after))
    share = (a.after - a.before) / (a.before + a.after)
    slope = differences.atanhc(share) / a.mean
    return make.made(ca.log(a.before), ca.log(a.after), [(a, slope)])


def _log10(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return _quotient(make, [_log(make, arguments), make.constant(ca.log(SX(10)))])


def _sinh(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return _halved(make, _difference, arguments[0])


def _cosh(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return _halved(make, _sum, arguments[0])


def _halved(make: Arithmetic, rule: Rule, a: Chord) -> Chord:
    both = rule(make, [_exp(make, [a]), _exp(make, [_negative(make, [a])])])
    return _times(make, make.constant(SX(0.5)), both)


def _tanh(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """``tanh(a1) - tanh(a0) = tanh(a1 - a0) (1 - tanh(a0) tanh(a1))``."""
    (a,) = arguments
    before, after = ca.tanh(a.before), ca.tanh(a.after)
    slope = differences.tanhc(a.after - a.before) * (1 - before * after)
    return make.made(before, after, [(a, slope)])


def _atan(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    return _atan2(make, [arguments[0], make.constant(SX(1))])


def _atan2(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """The angle from the vector before to that after, less than half a turn."""
    y, x = arguments
    cross = y.after * x.before - y.before * x.after
    along = x.before * x.after + y.before * y.after
    share = differences.turn_over_cross(cross, along)
    before = ca.atan2(y.before, x.before)
    return make.made(before, before + share * cross, [(y, share * x.mean), (x, -share * y.mean)])


def _abs(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """``(a1^2 - a0^2) / (abs(a0) + abs(a1))``."""
    (a,) = arguments
    before, after = ca.fabs(a.before), ca.fabs(a.after)
    return make.made(before, after, [(a, 2 * a.mean / (before + after + _FAINT))])


def _extreme(sign: float, make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """``(a + b +- abs(a - b)) / 2``, by twos."""

    def of_two(a: Chord, b: Chord) -> Chord:
        apart = _abs(make, [_difference(make, [a, b])])
        signed = _times(make, make.constant(SX(sign)), apart)
        return _times(make, make.constant(SX(0.5)), _sum(make, [a, b, signed]))

    return functools.reduce(of_two, arguments)


def _sign(make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    """A jump, where there is one, over the change that makes it."""
    (a,) = arguments
    before, after = ca.sign(a.before), ca.sign(a.after)
    jump = after - before
    return make.made(before, after, [(a, jump / ca.if_else(jump, a.after - a.before, 1.0))])


def _corrected(function: str, make: Arithmetic, arguments: Sequence[Chord]) -> Chord:
    (a,) = arguments
    before, after = (SX(FUNCTIONS[function](one)) for one in (a.before, a.after))
    return make.made(before, after, [(a, differences.corrected(function, a.before, a.after))])


RULES: Mapping[str, Rule] = MappingProxyType(
    {
        "+": _sum,
        "-": _difference,
        "neg": _negative,
        "*": _product,
        "/": _quotient,
        "^": _power,
        "sqrt": _sqrt,
        "hypot": _hypot,
        "sin": _sin,
        "cos": _cos,
        "tan": _tan,
        "exp": _exp,
        "log": _log,
        "log10": _log10,
        "sinh": _sinh,
        "cosh": _cosh,
        "tanh": _tanh,
        "atan": _atan,
        "atan2": _atan2,
        "abs": _abs,
        "sign": _sign,
        "min": functools.partial(_extreme, -1.0),
        "max": functools.partial(_extreme, 1.0),
        **{
            name: functools.partial(_corrected, name)
            for name in ("asin", "acos", "asinh", "acosh", "atanh")
        },
    }
)
"""Every operator and function of the language; its arguments to what it makes of them."""
