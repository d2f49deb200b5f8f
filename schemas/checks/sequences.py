"""How long the modes of a sequence last: each of them, and all of them in the phase's time."""

import math
from collections.abc import Iterator, Sequence

from schemas.checks.constants import Constants, Interval
from schemas.errors import Issue
from schemas.methods import Hybrid
from schemas.pointers import Part, pointer

_SAME = 1e-9  # relative: sums of decimal numbers are not exact

_Place = tuple[Part, ...]


def each(method: Hybrid, constants: Constants, place: _Place) -> tuple[list[Issue], list[Interval]]:
    """What is wrong with single durations; all of them, in s, where nothing is."""
    issues: list[Issue] = []
    found: list[Interval] = []
    for index, mode in enumerate(method.sequence):
        if mode.duration is None:
            found.append((0.0, math.inf))
            continue
        parts = (*place, "sequence", index, "duration")
        interval = constants.interval(mode.duration, parts)
        issues += constants.drain()
        if interval is not None and interval[1] <= 0:
            message = f"the mode cannot last: its duration is {interval[1]:g} at the most"
            issues.append(Issue(pointer(*parts), message, "a duration is more than 0"))
        elif interval is not None:
            found.append((max(interval[0], 0.0), interval[1]))
    return issues, found


def together(modes: Sequence[Interval], allowed: Interval, place: _Place) -> Iterator[Issue]:
    """The modes fill the phase, which lasts as long as ``allowed``, in s."""
    least, most = (math.fsum(mode[side] for mode in modes) for side in (0, 1))
    slack = _SAME * max(least, 1.0)
    if least > allowed[1] + slack:
        longest = max(range(len(modes)), key=lambda index: modes[index][0])
        yield Issue(
            pointer(*place, "sequence", longest, "duration"),
            f"the modes last {least:g} s together at the least, the phase {allowed[1]:g} s at the "
            "most",
            "shorten this mode, or give the phase more time",
        )
    elif most < allowed[0] - slack:
        shortest = min(range(len(modes)), key=lambda index: modes[index][1])
        yield Issue(
            pointer(*place, "sequence", shortest, "duration"),
            f"the modes last {most:g} s together at the most, the phase {allowed[0]:g} s at the "
            "least",
            "leave this duration open, or give the phase less time",
        )
