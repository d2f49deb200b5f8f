"""The homotopy: one program solved again and again, while its relaxation falls to nearly nothing.

Each pass starts from the point and the multipliers of the one before. Only limits change: those
of the relaxation's column, and those of the pair rows. Seed 000, section 3.2, and Scholtes (2001).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from schemas.results import HomotopyPass, finite
from solver.backends import FEASIBLE, NlpStatus, Outcome, Strategy
from solver.complementarity.ladder import INEQUALITY, Ladder
from solver.complementarity.pairs import Pairing
from solver.complementarity.relaxations import AT_MOST, FORMS
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

OVER = (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT)
_SOLVED = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE)


class Attempt(Protocol):
    """One solve of a task, watched and judged as the caller does it."""

    def __call__(self, task: NlpTask, strategy: Strategy, *, warm: bool) -> Outcome:
        """Solve; ``warm``: the start is nearly optimal."""
        ...


@dataclass(frozen=True, slots=True)
class Relaxed:
    """A program with pairs and the form in which it states their rows.

    ``pinned`` (k,) are pairs that only ever take inequalities.
    """

    task: NlpTask
    pairing: Pairing
    stated: str
    pinned: Mask

    def at(self, eps: float, form: str) -> NlpTask:
        """The program at a relaxation."""
        rows = self.pairing.rows
        lower, upper = self._limits(form)
        row_lower, row_upper = self.task.row_lower.copy(), self.task.row_upper.copy()
        row_lower[rows], row_upper[rows] = lower, upper
        held = replace(self.task, row_lower=row_lower, row_upper=row_upper)
        return self.held(held, eps)

    def held(self, task: NlpTask, eps: float) -> NlpTask:
        """A task with its relaxation at a value."""
        column = self.pairing.column
        start, lower, upper = task.start.copy(), task.lower.copy(), task.upper.copy()
        start[column] = lower[column] = upper[column] = eps / self.pairing.scale
        return replace(task, start=start, lower=lower, upper=upper)

    def _limits(self, form: str) -> tuple[Array, Array]:
        """Of each pair's row; a summed row is no equality, so that a pin changes nothing."""
        lower, upper = AT_MOST if form == INEQUALITY else FORMS[self.stated].limits
        pinned = self.pinned & (lower == upper)
        return np.where(pinned, AT_MOST[0], lower), np.where(pinned, AT_MOST[1], upper)


@dataclass(frozen=True, slots=True)
class Climb:
    """How far a homotopy came.

    Attributes
    ----------
    outcome
        Of the last good pass, and where there was none, of the last one.
    ladder
        What is left to do: nothing, where all went well.
    passes
        All passes, the failed ones, too.
    over
        Whether a stop or the time limit ended it.
    paused
        Whether there is more to try, from a point that may already be good enough.
    """

    outcome: Outcome
    ladder: Ladder
    passes: tuple[HomotopyPass, ...]
    over: bool = False
    paused: bool = False

    @property
    def reached(self) -> float | None:
        """The smallest relaxation that was solved."""
        return self.ladder.reached

    @property
    def stalled(self) -> bool:
        """Whether some passes were good, and then nothing helped."""
        return self.reached is not None and bool(self.ladder.levels) and not self.over


def climb(
    relaxed: Relaxed,
    ladder: Ladder,
    attempt: Attempt,
    on_pass: Callable[[HomotopyPass], None],
    *,
    warm: bool,
    near: float = 0.0,
    before: Climb | None = None,
) -> Climb:
    """Go down the ladder until it ends, nothing is left to try, or the time is over.

    It pauses where a pass fails after one at most ``near`` was good; ``before`` is such a pause,
    or the end of another ladder, from which it goes on.
    """
    passes, last = list(before.passes if before else ()), None
    good = before.outcome if before else None
    while ladder.levels:
        task = relaxed.at(ladder.levels[0], ladder.form)
        begin = task if good is None else resumed(task, good)
        last = attempt(begin, ladder.strategy, warm=warm or good is not None)
        passes.append(reported(relaxed.pairing, ladder.levels[0], ladder.form, last))
        on_pass(passes[-1])
        if last.status in OVER:
            return Climb(_ended(good, last), ladder, tuple(passes), over=True)
        if last.status in _SOLVED and last.point.violation <= FEASIBLE:
            good, ladder = last, ladder.on()
            continue
        if (again := ladder.back()) is None:
            break
        if good is not None and ladder.reached is not None and ladder.reached <= near:
            return Climb(good, again, tuple(passes), paused=True)
        ladder = again
    if (outcome := good or last) is None:
        raise ValueError("a schedule has one relaxation at the least")
    return Climb(outcome, ladder, tuple(passes))


def resumed(task: NlpTask, outcome: Outcome) -> NlpTask:
    """A task that starts where another one was solved, its multipliers included.

    Variables whose limits have moved are moved with them; what is fixed or open pushes no more.
    """
    start = np.clip(outcome.point.z, task.lower, task.upper)
    rows, bounds = outcome.row_multipliers, outcome.bound_multipliers
    if rows is None or bounds is None:
        return replace(task, start=start)
    open_rows = np.isinf(task.row_lower) & np.isinf(task.row_upper)
    return replace(
        task,
        start=start,
        row_multipliers=np.where(open_rows, 0.0, rows),
        bound_multipliers=np.where(task.lower == task.upper, 0.0, bounds),
    )


def reported(pairing: Pairing, eps: float, form: str, outcome: Outcome) -> HomotopyPass:
    """A pass as results and events tell it."""
    return HomotopyPass(
        relaxation=eps,
        form=form,
        status=outcome.status.value,
        nlp_iterations=outcome.iterations,
        objective=finite(outcome.point.objective),
        residual=finite(pairing.residuals(outcome.point.z)[1]),
        seconds=outcome.seconds,
    )


def _ended(good: Outcome | None, last: Outcome) -> Outcome:
    """Where the time was over: the last good point, whose relaxation is met."""
    return last if good is None else replace(good, status=last.status, raw=last.raw)
