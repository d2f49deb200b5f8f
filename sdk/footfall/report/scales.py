"""From numbers to places on an axis, and the ticks a person wants to read there."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from footfall.curves import Floats

_TINY = 1e-300
_NEARLY = 1e-4  # of a step: an end that is nearly a round number has its tick
_SUPERSCRIPTS = str.maketrans(
    "-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"
)


@dataclass(frozen=True, slots=True)
class Scale:
    """An axis from ``low`` to ``high``, both above zero where it is ``log``.

    ``whole``: it counts something, so its ticks are whole numbers.
    """

    low: float
    high: float
    log: bool = False
    whole: bool = False

    def at(self, values: ArrayLike) -> Floats:
        """Places from 0 (low) to 1 (high)."""
        low, high, inner = self.low, self.high, np.asarray(values, dtype=float)
        if self.log:
            inner = np.log10(np.maximum(inner, low))  # zero sits at the foot of the axis
            low, high = math.log10(low), math.log10(high)
        return (inner - low) / (high - low)

    def ticks(self, count: int) -> list[tuple[float, str]]:
        """About ``count`` places from 0 to 1, with their labels."""
        values = self._decades(count) if self.log else self._steps(count)
        return [(float(self.at(value)), label) for value, label in values]

    def _steps(self, count: int) -> list[tuple[float, str]]:
        rough = _nice_step((self.high - self.low) / max(count, 1))
        step = max(rough, 1.0) if self.whole else rough
        decimals = max(0, -math.floor(math.log10(step) + 1e-9))
        first = math.ceil(self.low / step - _NEARLY)
        last = math.floor(self.high / step + _NEARLY)
        return [(k * step, _label(k * step, decimals)) for k in range(first, last + 1)]

    def _decades(self, count: int) -> list[tuple[float, str]]:
        first, last = (
            math.ceil(math.log10(self.low) - 1e-9),
            math.floor(math.log10(self.high) + 1e-9),
        )
        stride = max(1, math.ceil((last - first) / max(count, 1)))
        return [(10.0**k, power_of_ten(k)) for k in range(first, last + 1, stride)]


def linear(values: Iterable[float], margin: float = 0.06) -> Scale:
    """An axis that holds all values, with a margin; of some height even if they are all one."""
    finite = [value for value in values if math.isfinite(value)] or [0.0]
    low, high = min(finite), max(finite)
    least = max(abs(low), abs(high), 1e-3) * 1e-9
    pad = margin * (high - low) if high - low > least else max(abs(high) * 0.1, 0.1)
    return Scale(low - pad, high + pad)


def logarithmic(values: Iterable[float]) -> Scale:
    """An axis of whole decades that holds all values above zero."""
    positive = [value for value in values if math.isfinite(value) and value > _TINY] or [1.0]
    low = math.floor(math.log10(min(positive)) - 0.05)
    high = math.ceil(math.log10(max(positive)) + 0.05)
    return Scale(10.0**low, 10.0 ** max(high, low + 1), log=True)


def power_of_ten(exponent: int) -> str:
    """Ten to the ``exponent``, set with superscripts."""
    return "10" + str(exponent).translate(_SUPERSCRIPTS)


def scientific(value: float | None, digits: int) -> str:
    """A number with ``digits`` significant digits, set for reading; a dash for none."""
    if value is None:
        return "\N{EN DASH}"
    mantissa, _, exponent = f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}").partition("e")
    if not exponent:
        return mantissa
    power = power_of_ten(int(exponent.replace("\N{MINUS SIGN}", "-")))
    return power if mantissa == "1" else f"{mantissa} \N{MULTIPLICATION SIGN} {power}"


def _nice_step(rough: float) -> float:
    power = 10.0 ** math.floor(math.log10(rough))
    return min(
        (power * nice for nice in (1.0, 2.0, 5.0, 10.0)), key=lambda s: abs(math.log(s / rough))
    )


def _label(value: float, decimals: int) -> str:
    if abs(value) >= 1e6 or decimals > 9:
        text = f"{value:.4g}"
    else:
        text = f"{value + 0.0:.{decimals}f}"
    return text.replace("-", "\N{MINUS SIGN}") if float(text) else text.lstrip("-")
