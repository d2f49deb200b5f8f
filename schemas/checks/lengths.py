"""How long each phase may last, as far as its times alone tell."""

import math
from collections.abc import Iterator

from schemas.checks.constants import Constants, Interval
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.values import Bound

_OPEN: Interval = (-math.inf, math.inf)


def lengths(problem: Problem) -> Iterator[Interval | None]:
    """The shortest and the longest duration of each phase, s; None where times are broken."""
    start: Interval | None = None
    for index, phase in enumerate(problem.phases):
        constants = Constants.of(phase, ("phases", index))
        if index == 0:
            start = _given(phase.time.start, constants)
        final, duration = (_given(one, constants) for one in _ends(phase))
        if start is None or final is None or duration is None:
            start = None
            yield None
            continue
        least = max(duration[0], final[0] - start[1], 0.0)
        most = min(duration[1], final[1] - start[0])
        yield (least, most) if least <= most else None
        start = max(start[0] + least, final[0]), min(start[1] + most, final[1])


def _ends(phase: Phase) -> tuple[Bound | None, Bound | None]:
    return phase.time.final, phase.time.duration


def _given(bound: Bound | None, constants: Constants) -> Interval | None:
    return _OPEN if bound is None else constants.interval(bound, ())
