"""Where a model breaks at its guess: which expression, when, and a pointer into the problem."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from schemas.errors import InvalidModel, Issue
from schemas.expressions import Expression
from schemas.phases import Phase
from schemas.problem import Problem
from solver.nlp.task import NlpTask
from solver.numeric import along
from solver.trajectory import Trajectory

Array = NDArray[np.float64]

_SAMPLES = 401
_PUSH = 1e-2  # of a variable's size, and of the width of its bounds
_HINT = (
    "Give a guess, or bounds, that keep the motion where this expression has a value "
    "(no division by zero, no root or logarithm of a negative number)."
)


def check_start(problem: Problem, task: NlpTask, guesses: Sequence[Trajectory]) -> None:
    """Refuse a start at which the program has no finite values.

    Tried a little inside of the bounds, where an interior-point solver starts.

    Raises
    ------
    InvalidModel
        Naming the expressions that have none, and the first time at which they have none.
    """
    if all(np.all(np.isfinite(part.full())) for part in task.nlp.evaluate(_inside(task))):
        return
    issues = [
        issue
        for index, (phase, guess) in enumerate(zip(problem.phases, guesses, strict=True))
        for issue in _broken(f"/phases/{index}", phase, guess)
    ]
    anywhere = Issue("/objective/minimize", "has no finite value at the initial guess", _HINT)
    raise InvalidModel(issues or [anywhere])


def _inside(task: NlpTask) -> Array:
    """The start, moved off its bounds."""
    room = np.minimum(_PUSH, _PUSH * (task.upper - task.lower))
    return np.clip(task.start, task.lower + room, task.upper - room)


def _broken(pointer: str, phase: Phase, guess: Trajectory) -> Iterator[Issue]:
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    times = guess.start + (guess.end - guess.start) * fractions
    x, u = guess.sample_states(fractions), guess.sample_controls(fractions)
    named = list(_expressions(phase))
    with np.errstate(all="ignore"):
        values = along(phase.system, [expression.tree for _, expression in named])(times, x, u)
    for (place, _), row in zip(named, values, strict=True):
        bad = np.flatnonzero(~np.isfinite(row))
        if len(bad):
            message = (
                f"has no finite value at the initial guess, first at t = {times[bad[0]]:.4g} s"
            )
            yield Issue(pointer + place, message, _HINT)


def _expressions(phase: Phase) -> Iterator[tuple[str, Expression]]:
    system = phase.system
    for name, expression in system.define.items():
        yield f"/system/define/{name}", expression
    for name in system.states:
        yield f"/system/derivatives/{name}", system.derivatives[name]
    for name, expression in phase.integrals.items():
        yield f"/integrals/{name}", expression
    for index, row in enumerate(phase.path):
        yield f"/path/{index}/expression", row.expression
