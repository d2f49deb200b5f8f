"""The polish: of each pair one member is pinned at zero, and the relaxation is gone.

Which one is what the homotopy has found out: the smaller. The other stays at least zero, so that
each solution is exact, and a best one among those that have the same members at zero. Where both
members come out as zero, the multipliers tell whether it would pay to let the pinned one go
instead; then they change places, and it is solved again.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from solver.backends import DEFAULT, NlpStatus, Outcome
from solver.complementarity.homotopy import OVER, Attempt, Relaxed, resumed
from solver.complementarity.ladder import MONOTONE
from solver.complementarity.relaxations import FORMS
from solver.complementarity.stationarity import Stationarity, stationarity
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Sides = NDArray[np.int_]

_ROUNDS = 4  # of changing places
_WORSE = 0.1  # of the objective: the pinned solve has gone elsewhere
_SMALL = 1e-3  # of an objective near zero
_GAIN = 1e-9  # of the objective: less is no reason to change places again


@dataclass(frozen=True, slots=True)
class Polished:
    """An exact solution and its kind of stationarity; what all solves took.

    ``outcome`` is None where the polish came to nothing, and ``over`` how it ended where a stop or
    the time limit is why.
    """

    outcome: Outcome | None
    iterations: int
    seconds: float
    stationarity: Stationarity | None = None
    over: NlpStatus | None = None

    @property
    def unfinished(self) -> bool:
        """Whether it came to nothing, with time left."""
        return self.outcome is None and self.over is None


def polish(relaxed: Relaxed, found: Outcome, eps: float, attempt: Attempt) -> Polished:
    """Solve with the smaller member of each pair at zero, from a solution relaxed to ``eps``."""
    sides = np.abs(relaxed.pairing.values(found.point.z)).argmin(axis=1)
    task = _pinned(relaxed, sides, eps)
    outcome = _solved(task, found, attempt)
    if not _sound(outcome, found):
        over = outcome.status if outcome.status in OVER else None
        return Polished(None, outcome.iterations, outcome.seconds, over=over)
    kind = stationarity(task, relaxed.pairing, outcome)
    polished = Polished(outcome, outcome.iterations, outcome.seconds, kind)
    for _ in range(_ROUNDS):
        swapped = _swapped(polished.stationarity, sides)
        if np.array_equal(swapped, sides):
            break
        better = _better(relaxed, _pinned(relaxed, swapped, eps), polished, attempt)
        if better.outcome is polished.outcome:
            return better
        sides, polished = swapped, better
    return polished


def _better(relaxed: Relaxed, task: NlpTask, polished: Polished, attempt: Attempt) -> Polished:
    """The solution with other members pinned, where that is the better one."""
    if polished.outcome is None:
        return polished
    other = attempt(resumed(task, polished.outcome), DEFAULT, warm=True)
    took = replace(
        polished,
        iterations=polished.iterations + other.iterations,
        seconds=polished.seconds + other.seconds,
    )
    before, after = polished.outcome.point.objective, other.point.objective
    if other.status is not NlpStatus.OPTIMAL or before - after <= _GAIN * (1 + abs(before)):
        return took
    kind = stationarity(task, relaxed.pairing, other)
    return replace(took, outcome=other, stationarity=kind)


def _pinned(relaxed: Relaxed, sides: Sides, eps: float) -> NlpTask:
    """The task with one member of each pair at zero, and its pair rows open."""
    pairing, task = relaxed.pairing, relaxed.task
    lower, upper = task.lower.copy(), task.upper.copy()
    chosen = pairing.members[np.arange(len(sides)), sides]
    lower[chosen] = upper[chosen] = 0.0
    row_lower, row_upper = task.row_lower.copy(), task.row_upper.copy()
    row_lower[pairing.rows], row_upper[pairing.rows] = -np.inf, np.inf
    pinned = replace(task, lower=lower, upper=upper, row_lower=row_lower, row_upper=row_upper)
    form = FORMS[relaxed.stated]
    return relaxed.held(pinned, 0.0 if form.limit and not form.priced else eps)


def _solved(task: NlpTask, found: Outcome, attempt: Attempt) -> Outcome:
    """To the problem's own tolerance; where that is out of reach, to that of the homotopy."""
    begin = resumed(task, found)
    outcome = attempt(begin, DEFAULT, warm=True)
    if outcome.status is NlpStatus.OPTIMAL or outcome.status in OVER:
        return outcome
    again = attempt(begin, MONOTONE, warm=True)
    return replace(
        again,
        iterations=outcome.iterations + again.iterations,
        seconds=outcome.seconds + again.seconds,
    )


def _sound(outcome: Outcome, found: Outcome) -> bool:
    """Whether it is solved, at an objective that has to do with the one found before."""
    before, after = found.point.objective, outcome.point.objective
    near = after <= before + _WORSE * abs(before) + _SMALL
    return outcome.status is NlpStatus.OPTIMAL and near


def _swapped(kind: Stationarity | None, sides: Sides) -> Sides:
    """The other member at zero wherever both are, and the pinned one would rather grow."""
    if kind is None:
        return sides
    pulls = kind.multipliers[np.arange(len(sides)), sides]
    size = max(1.0, float(np.abs(kind.multipliers).max(initial=0.0)))
    return np.where(kind.biactive & (pulls < -1e-6 * size), 1 - sides, sides)
