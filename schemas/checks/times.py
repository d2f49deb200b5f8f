"""A phase starts at some time and can last."""

import math
from collections.abc import Iterator

from schemas.checks.constants import Constants
from schemas.errors import Issue
from schemas.pointers import pointer
from schemas.problem import Problem


def check(problem: Problem) -> Iterator[Issue]:
    """The initial time is bounded; some final time lies after some initial time."""
    for index, phase in enumerate(problem.phases):
        place = ("phases", index, "time")
        constants = Constants.of(phase, ("phases", index))
        constants.issues.clear()  # the parameters' issues are reported by the check of limits
        initial = constants.interval(phase.time.start, (*place, "initial"))
        final = constants.interval(phase.time.final, (*place, "final"))
        yield from constants.drain()
        if initial is None or final is None:
            continue
        if math.isinf(initial[0]) or math.isinf(initial[1]):
            yield Issue(
                pointer(*place, "initial"),
                "an initial time without a limit",
                "fix it, or bound it on both sides; the final time may stay open",
            )
        elif final[1] <= initial[0]:
            yield Issue(
                pointer(*place, "final"),
                f"the phase cannot last: it starts at {initial[0]:g} at the earliest "
                f"and ends at {final[1]:g} at the latest",
                "move 'final' past 'initial'",
            )
