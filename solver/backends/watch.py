"""The watch over a running solve: deadline, stop requests, progress, and the best iterate."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEASIBLE = 1e-6
"""Scaled violation below which an iterate counts as feasible when the best one is chosen."""

_BOTTOMLESS = 1e9
"""A feasible objective so many times below the size of the first one has no lower end."""


def _let_go(_: object) -> None:
    """Keep nothing."""


class StopCause(StrEnum):
    """Why the watch ended a solve."""

    DEADLINE = "deadline"
    REQUEST = "request"
    UNBOUNDED = "unbounded"


@dataclass(frozen=True, slots=True)
class Iterate:
    """A point of the iteration, with its objective and its largest scaled violation."""

    z: Array
    rows: Array
    objective: float
    violation: float

    def better_than(self, other: "Iterate") -> bool:
        """Smaller violation until feasible, then lower objective."""
        if max(self.violation, other.violation) > FEASIBLE:
            return self.violation < other.violation
        return self.objective < other.objective


@dataclass(slots=True)
class Watch:
    """Sees every iteration of one NLP solve.

    Attributes
    ----------
    deadline
        When to end, in seconds of ``time.monotonic``; infinite for never.
    should_stop
        Asked at every iteration.
    report
        Called at every iteration with its number, objective and violation.
    keep
        Called when ``best`` has become better.
    """

    deadline: float
    should_stop: Callable[[], bool]
    report: Callable[[int, float, float], None]
    keep: Callable[["Watch"], None] = _let_go
    best: Iterate | None = None
    cause: StopCause | None = None
    fault: Exception | None = None
    first: float | None = None
    iterations: int = field(default=-1)

    def remaining(self) -> float:
        """Seconds until the deadline."""
        return self.deadline - time.monotonic()

    def see(self, iterate: Iterate) -> bool:
        """Take note of an iterate; whether the solver shall stop.

        An exception of a callback is kept in ``fault``, since solvers swallow it.
        """
        self.iterations += 1
        finite = math.isfinite(iterate.objective) and math.isfinite(iterate.violation)
        better = finite and (self.best is None or iterate.better_than(self.best))
        if better:
            self.best = iterate
        try:
            if better:
                self.keep(self)
            self.report(self.iterations, iterate.objective, iterate.violation)
            if self.should_stop():
                self.cause = StopCause.REQUEST
        except Exception as error:  # noqa: BLE001 - kept and raised again outside of the solver
            self.fault = error
        if self.cause is None and self._bottomless(iterate):
            self.cause = StopCause.UNBOUNDED
        if self.cause is None and self.remaining() <= 0:
            self.cause = StopCause.DEADLINE
        return self.cause is not None or self.fault is not None

    def _bottomless(self, iterate: Iterate) -> bool:
        """Whether the objective falls without limit; solvers would follow it to their own."""
        if self.first is None:
            self.first = iterate.objective
        low = iterate.objective < -_BOTTOMLESS * (1 + abs(self.first))
        return low and iterate.violation <= FEASIBLE
