"""From numbers to rows of the certificate: the worst finding, where it is, whether it passes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from schemas.results import Check
from solver.numeric import Array


@dataclass(frozen=True, slots=True)
class Finding:
    """How far off, relative and never negative, and where; NaN where there is no value."""

    value: float
    where: str

    @property
    def rank(self) -> float:
        """Orders findings; one without a value is the worst there can be."""
        return self.value if math.isfinite(self.value) else math.inf


def worst_sample(phase: str, names: Sequence[str], times: Array, sizes: Array) -> Finding:
    """The largest of ``sizes`` (names, times), or the first that is not a number."""
    row, column = divmod(int(np.argmax(sizes)), sizes.shape[1])
    place = f"phase {phase}, {names[row]}, t = {times[column]:.6g} s"
    return Finding(float(sizes[row, column]), place)


def violation(values: Array, limits: tuple[float, float]) -> Array:
    """How far values lie outside of ``(lower, upper)``, relative to one plus the limit's size.

    What is not a number keeps no limit, open ones included.
    """
    lower, upper = limits
    beyond = np.where(np.isnan(values), np.nan, 0.0)
    if math.isfinite(lower):
        beyond = np.maximum(beyond, (lower - values) / (1 + abs(lower)))
    if math.isfinite(upper):
        beyond = np.maximum(beyond, (values - upper) / (1 + abs(upper)))
    return beyond


def judge(
    name: str,
    findings: Sequence[Finding],
    tolerance: float | None,
    judged: bool = True,
    unit: str = "relative",
) -> Check | None:
    """The row of the worst finding; None where there was nothing to look at.

    A row that is only reported has no tolerance and passes wherever it has a value.
    """
    if not findings:
        return None
    worst = max(findings, key=lambda finding: finding.rank)
    finite = math.isfinite(worst.value)
    return Check(
        name=name,
        value=worst.value if finite else None,
        tolerance=tolerance,
        unit=unit,
        passed=finite and (tolerance is None or worst.value <= tolerance),
        judged=judged,
        where=None if worst.value == 0 else worst.where,
    )
