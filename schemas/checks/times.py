"""Phases follow each other, the first one starts at some time, and each of them can last."""

import math
from collections.abc import Iterator

from schemas.checks import sequences
from schemas.checks.constants import Constants, Interval
from schemas.errors import Issue
from schemas.methods import Hybrid
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem


def check(problem: Problem) -> Iterator[Issue]:
    """Only the first phase says when it starts; some times fit all phases in a row."""
    start: Interval | None = None
    for index, phase in enumerate(problem.phases):
        place = ("phases", index, "time")
        constants = Constants.of(phase, ("phases", index))
        constants.issues.clear()  # the parameters' issues are reported by the check of limits
        if index == 0:
            start = constants.interval(phase.time.start, (*place, "initial"))
            if start is not None and (math.isinf(start[0]) or math.isinf(start[1])):
                yield Issue(
                    pointer(*place, "initial"),
                    "an initial time without a limit",
                    "fix it, or bound it on both sides; the final time may stay open",
                )
                start = None
        elif phase.time.initial is not None:
            yield Issue(
                pointer(*place, "initial"),
                f"this phase starts when '{problem.phases[index - 1].name}' ends",
                "take it away; only the first phase has an 'initial' time",
            )
        duration = _given(phase, "duration", constants, place)
        final = _given(phase, "final", constants, place)
        yield from constants.drain()
        modes = _Modes(problem, index, constants)
        yield from modes.issues
        if start is None or duration is None or final is None:
            start = None
            continue
        end = max(start[0] + max(duration[0], 0), final[0]), min(start[1] + duration[1], final[1])
        broken = list(_cannot_last(start, duration, final, end, place))
        yield from broken or modes.misfits(start, duration, final)
        start = end if start[0] < end[1] and end[0] <= end[1] else None


class _Modes:
    """The modes of a phase that has a sequence."""

    def __init__(self, problem: Problem, index: int, constants: Constants) -> None:
        phase = problem.phases[index]
        method = phase.method or problem.method
        self._place = ("phases", index, "method") if phase.method else ("method",)
        self.issues: list[Issue] = []
        self._lasting: list[Interval] = []
        if isinstance(method, Hybrid):
            self.issues, self._lasting = sequences.each(method, constants, self._place)

    def misfits(self, start: Interval, duration: Interval, final: Interval) -> Iterator[Issue]:
        """Whether they fill the time from the start to the end."""
        if self._lasting and not self.issues:
            allowed = (
                max(duration[0], final[0] - start[1], 0.0),
                min(duration[1], final[1] - start[0]),
            )
            yield from sequences.together(self._lasting, allowed, self._place)


def _given(
    phase: Phase, field: str, constants: Constants, place: tuple[Part, ...]
) -> Interval | None:
    """The interval of ``final`` or ``duration``, open where it is left out; None where broken."""
    bound = getattr(phase.time, field)
    if bound is None:
        return -math.inf, math.inf
    return constants.interval(bound, (*place, field))


def _cannot_last(
    start: Interval, duration: Interval, final: Interval, end: Interval, place: tuple[Part, ...]
) -> Iterator[Issue]:
    if duration[1] <= 0:
        message = f"the phase cannot last: its duration is {duration[1]:g} at the most"
        yield Issue(pointer(*place, "duration"), message, "a duration is more than 0")
    elif final[1] <= start[0]:
        yield Issue(
            pointer(*place, "final"),
            f"the phase cannot last: it starts at {start[0]:g} at the earliest "
            f"and ends at {final[1]:g} at the latest",
            "move 'final' past the start of the phase",
        )
    elif end[0] > end[1]:
        yield Issue(
            pointer(*place),
            f"'final' and 'duration' do not fit: with its start in {_span(start)} and its duration "
            f"in {_span(duration)} the phase cannot end in {_span(final)}",
            "widen one of them",
        )


def _span(interval: Interval) -> str:
    return f"[{interval[0]:g}, {interval[1]:g}]"
