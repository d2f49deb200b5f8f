"""A portfolio: where one strategy fails, the next one is tried, and the result says which won."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from schemas.problem import SolverSettings
from solver.backends import (
    ADAPTIVE,
    DEFAULT,
    FEASIBLE,
    RESCALED,
    Backend,
    NlpStatus,
    Outcome,
    Strategy,
    Watch,
)
from solver.backends.plugin import iterate_at
from solver.nlp.elastic import Elastic, elastic
from solver.nlp.task import NlpTask

Mask = NDArray[np.bool_]

STRATEGIES = (DEFAULT, ADAPTIVE, RESCALED)
"""What is tried, but for the first, where the backend knows it; the elastic start comes last."""

ELASTIC = "elastic start"
LIMITS = "elastic limits"

_WORTH_ANOTHER = (
    NlpStatus.INFEASIBLE,
    NlpStatus.DIVERGED,
    NlpStatus.ITERATION_LIMIT,
    NlpStatus.INVALID_NUMBER,
    NlpStatus.ACCEPTABLE,
)
_OVER = (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT)


@dataclass(frozen=True, slots=True)
class Won:
    """An outcome, the strategy that gave it, and how those before it ended."""

    outcome: Outcome
    strategy: str = DEFAULT.name
    attempts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Portfolio:
    """What the attempts share.

    Attributes
    ----------
    backend, settings
        Who solves, and how long.
    attempt
        One solve of a task by a strategy, watched and judged as the caller does it.
    watch
        A new watch, for the elastic solve before the last attempt.
    announce
        Hears of each attempt before it begins.
    limits
        Rows (m,) and variables (n,) whose limits may give way on the way to a start from which
        the dynamics hold; None to let all rows give way at once only.
    """

    backend: Backend
    settings: SolverSettings
    attempt: Callable[[NlpTask, Strategy], Outcome]
    watch: Callable[[], Watch]
    announce: Callable[[str], None]
    limits: tuple[Mask, Mask] | None = None

    def solve(self, task: NlpTask, first: Outcome, tried: Strategy = DEFAULT) -> Won:
        """Try the strategies in turn until one ends at an optimum.

        ``first`` is the outcome of the strategy that was ``tried``. Where none does better, the
        best of all is returned: the smallest violation until feasible, then the lowest objective.
        """
        won, attempts = Won(first, tried.name), [_described(tried.name, first)]
        for name, attempt in self._attempts(task, tried):
            if won.outcome.status not in _WORTH_ANOTHER:
                break
            self.announce(f"again, {name}")
            outcome = attempt()
            if outcome.status is NlpStatus.OPTIMAL or _better(outcome, won.outcome):
                won = Won(outcome, name)
            if outcome.status in _OVER:
                # What was asked for counts, also where an earlier attempt came further.
                won = replace(won, outcome=replace(won.outcome, status=outcome.status))
            attempts.append(_described(name, outcome))
        others = [line for line in attempts if not line.startswith(f"{won.strategy}: ")]
        return replace(won, attempts=tuple(others))

    def _attempts(
        self, task: NlpTask, tried: Strategy
    ) -> Iterator[tuple[str, Callable[[], Outcome]]]:
        for strategy in STRATEGIES:
            if strategy != tried and self.backend.offers(strategy):
                yield strategy.name, partial(self.attempt, task, strategy)
        every = np.ones(len(task.row_lower), dtype=bool)
        ways = [(ELASTIC, (every, np.zeros(len(task.start), dtype=bool)))]
        if self.limits is not None:
            ways.append((LIMITS, self.limits))
        for name, (rows, bounds) in ways:
            relaxed = elastic(task, rows, bounds)
            if not self.backend.refusal(relaxed.task):
                yield name, partial(self._from_elastic, task, relaxed)

    def _from_elastic(self, task: NlpTask, relaxed: Elastic) -> Outcome:
        """First the point that violates the least; where that is nothing, the optimum from it."""
        watch = self.watch()
        silent = Watch(watch.deadline, watch.should_stop, watch.report)
        near = self.backend.solve(relaxed.task, self.settings, silent, warm=False)
        point = np.clip(relaxed.point(near.point.z), task.lower, task.upper)
        reached, over = iterate_at(task, point), near.status in _OVER
        if over or reached.violation > FEASIBLE:
            status = near.status if over else NlpStatus.INFEASIBLE
            return Outcome(status, near.raw, reached, near.iterations, near.seconds)
        outcome = self.attempt(replace(task, start=point), DEFAULT)
        return replace(
            outcome,
            iterations=near.iterations + outcome.iterations,
            seconds=near.seconds + outcome.seconds,
        )


def _better(one: Outcome, other: Outcome) -> bool:
    """Whether a failed attempt got further: closer to feasible, then lower, then accepted."""
    if max(one.point.violation, other.point.violation) <= FEASIBLE:
        accepted = [outcome.status is NlpStatus.ACCEPTABLE for outcome in (one, other)]
        if accepted[0] != accepted[1]:
            return accepted[0]
    return one.point.better_than(other.point)


def _described(name: str, outcome: Outcome) -> str:
    """As in ``default: infeasible after 40 iterations``."""
    ended = outcome.status.replace("_", " ")
    return f"{name}: {ended} after {outcome.iterations} iterations"
