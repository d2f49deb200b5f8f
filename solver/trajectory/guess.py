"""The initial guess: straight lines, constants or points, within the bounds (003, 7.6.1)."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from schemas import resolve
from schemas.guesses import ConstantGuess, Guess, PointsGuess
from solver.model import Interval, Phase
from solver.trajectory.trajectory import Trajectory, straight_lines

Array = NDArray[np.float64]


def initial_guess(phase: Phase, guess: Guess) -> Trajectory:
    """The trajectory from which the first mesh starts.

    Names that the guess leaves out go straight from their initial to their final value; an open
    end takes the other end's value, and two open ends the admissible value nearest to zero.
    """
    start, end = _span(phase.start, phase.end)
    times, given = _given(guess, phase.parameters)
    shares = (times - times[0]) / (times[-1] - times[0])
    times = start + (end - start) * shares

    def curves(names: tuple[str, ...]) -> Array:
        rows = [given.get(name, _line(phase, name, shares)) for name in names]
        return np.array(rows).reshape(len(names), len(times))

    return Trajectory(
        start,
        end,
        straight_lines(phase.states, times, curves(phase.states)),
        straight_lines(phase.controls, times, curves(phase.controls)),
    )


def _span(start: Interval, end: Interval) -> tuple[float, float]:
    """A start and an end within their limits, a typical duration apart."""
    first = _nearest(start, 0.0)
    shortest, longest = max(end.lower - first, 0.0), end.upper - first
    if math.isinf(longest):
        duration = max(2 * shortest, 1.0)
    elif shortest > 0:
        duration = math.sqrt(shortest * longest)
    else:
        duration = longest / 2
    return first, first + duration


def _given(guess: Guess, constants: Mapping[str, float]) -> tuple[Array, dict[str, Array]]:
    """The guess's own times and the values that it gives at them."""
    if isinstance(guess, PointsGuess):
        values = {
            name: np.array([resolve.scalar(value, constants) for value in column])
            for name, column in guess.values.items()
        }
        return np.array(guess.time), values
    times = np.array([0.0, 1.0])
    if isinstance(guess, ConstantGuess):
        return times, {
            name: np.full(2, resolve.scalar(value, constants))
            for name, value in guess.values.items()
        }
    return times, {}


def _line(phase: Phase, name: str, shares: Array) -> Array:
    """From the initial to the final value, at shares of the duration from 0 to 1."""
    initial, final = phase.initial[name], phase.final[name]
    if initial.fixed and final.fixed:
        ends = initial.lower, final.lower
    elif initial.fixed:
        ends = initial.lower, _nearest(final, initial.lower)
    elif final.fixed:
        ends = _nearest(initial, final.lower), final.lower
    else:
        ends = _nearest(initial, 0.0), _nearest(final, 0.0)
    return np.asarray(ends[0] + (ends[1] - ends[0]) * shares)


def _nearest(interval: Interval, value: float) -> float:
    return min(max(value, interval.lower), interval.upper)
