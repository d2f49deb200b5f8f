"""The time that a certificate may take: wild curves can keep an integrator busy for minutes."""

import math
import time
from dataclasses import dataclass


class OutOfTime(ArithmeticError):
    """A check did not end in time."""


@dataclass(frozen=True, slots=True)
class Clock:
    """Ends at ``until``, in seconds of ``time.monotonic``."""

    until: float = math.inf

    def look(self) -> None:
        """Raise `OutOfTime` where the time is over."""
        if time.monotonic() > self.until:
            raise OutOfTime


ENDLESS = Clock()
