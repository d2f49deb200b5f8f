"""The initial guess: lines, constants, points, noise or an earlier result (003, 7.6.1)."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas import resolve
from schemas.guesses import ConstantGuess, Guess, PointsGuess, RandomGuess, SolutionGuess
from solver.model import Interval, Model, Phase
from solver.trajectory.noise import noisy, noisy_values
from solver.trajectory.trajectory import Trajectory, straight_lines

Array = NDArray[np.float64]


def initial_guesses(model: Model, guesses: Sequence[Guess]) -> list[Trajectory]:
    """One trajectory for each phase, each starting when the one before it ends.

    Names that a guess leaves out go straight from their initial to their final value; an open
    end takes the other end's value, and two open ends the admissible value nearest to zero.
    """
    trajectories: list[Trajectory] = []
    only = len(model.phases) == 1
    for index, (phase, guess) in enumerate(zip(_in_time(model.phases), guesses, strict=True)):
        before = trajectories[-1].end if trajectories else None
        earlier = _earlier(guess, phase, only=only) if isinstance(guess, SolutionGuess) else None
        if earlier is not None:
            trajectories.append(_completed(_moved(earlier, phase, before), phase))
        else:
            trajectories.append(_guess(phase, guess, before, index))
    return trajectories


def _in_time(phases: Sequence[Phase]) -> list[Phase]:
    """The phases, each ending in time for the least durations and latest ends of those after it."""
    latest, known = math.inf, []
    for phase in reversed(phases):
        end = Interval(phase.end.lower, max(min(phase.end.upper, latest), phase.end.lower))
        known.append(replace(phase, end=end))
        latest = end.upper - max(phase.duration.lower, 0.0)
    return known[::-1]


def guessed_statics(model: Model, guess: Guess) -> list[float]:
    """The problem's statics: their own guesses, an earlier result's, or random ones."""
    values = [static.guess for static in model.statics]
    if isinstance(guess, SolutionGuess):
        return [
            guess.static.get(static.name, value)
            for static, value in zip(model.statics, values, strict=True)
        ]
    if isinstance(guess, RandomGuess):
        limits = [static.limits for static in model.statics]
        return noisy_values(values, limits, guess.seed, guess.spread)
    return values


def _guess(phase: Phase, guess: Guess, before: float | None, index: int) -> Trajectory:
    start, end = _span(phase, before, guess)
    about = guess.about or guess if isinstance(guess, RandomGuess) else guess
    times, given = _given(about, phase.parameters)
    shares = (times - times[0]) / (times[-1] - times[0])
    times = start + (end - start) * shares

    def curves(names: tuple[str, ...]) -> Curves:
        rows = [given.get(name, _line(phase, name, shares)) for name in names]
        return straight_lines(names, times, np.array(rows).reshape(len(names), len(times)))

    trajectory = Trajectory(start, end, curves(phase.states), curves(phase.controls))
    if isinstance(guess, RandomGuess):
        return noisy(trajectory, phase, guess.seed + 7919 * index, guess.spread)
    return trajectory


def _earlier(guess: SolutionGuess, phase: Phase, *, only: bool) -> Trajectory | None:
    """The earlier result's trajectory of this phase; the only phase takes an only one's."""
    found = [one for one in guess.phases if one.name == phase.name]
    if only and len(guess.phases) == 1:
        found = list(guess.phases)
    curves = found[0].curves if found else {}
    groups = {name: Curves.from_dict(group.model_dump()) for name, group in curves.items()}
    if not groups:
        return None
    breaks = next(iter(groups.values())).breaks
    start, end = float(breaks[0]), float(breaks[-1])
    empty = Curves([start, end], {})
    others = groups.get("rates") or groups.get("forces") or empty
    states, controls = (groups.get(name, empty) for name in ("states", "controls"))
    return Trajectory(start, end, states, controls, others)


def _completed(trajectory: Trajectory, phase: Phase) -> Trajectory:
    """With straight lines for what it does not know."""

    def whole(names: Sequence[str], known: Curves) -> Curves:
        missing = [name for name in names if trajectory.curve(name) is None]
        times = known.breaks
        shares = (times - times[0]) / ((times[-1] - times[0]) or 1.0)
        rows = np.array([_line(phase, name, shares) for name in missing])
        lines = straight_lines(missing, times, rows.reshape(len(missing), len(times)))
        both = {**known, **lines}
        return Curves(times, {name: curve.coefficients for name, curve in both.items()})

    return replace(
        trajectory,
        states=whole(phase.states, trajectory.states),
        controls=whole(phase.controls, trajectory.controls),
    )


def _moved(trajectory: Trajectory, phase: Phase, before: float | None) -> Trajectory:
    """The same motion, so that it starts where the phase can start."""
    start = _first(phase, before, trajectory.start)
    duration = trajectory.end - trajectory.start
    end = phase.end.nearest(start + phase.duration.nearest(duration))
    if end <= start:
        end = start + duration
    scale = (end - start) / duration if duration > 0 else 1.0

    def stretched(curves: Curves) -> Curves:
        breaks = start + scale * (curves.breaks - trajectory.start)
        return Curves(breaks, {name: curve.coefficients for name, curve in curves.items()})

    groups = (trajectory.states, trajectory.controls, trajectory.others)
    return Trajectory(start, end, *(stretched(group) for group in groups))


def _first(phase: Phase, before: float | None, wanted: float) -> float:
    """When a phase starts: where the one before it ends, or as near to ``wanted`` as it can."""
    if before is not None:
        return before
    return wanted if phase.start is None else phase.start.nearest(wanted)


def _span(phase: Phase, before: float | None, guess: Guess) -> tuple[float, float]:
    """A start and an end within their limits, a typical duration apart."""
    first = _first(phase, before, 0.0)
    shortest = max(phase.end.lower - first, phase.duration.lower, 0.0)
    longest = max(min(phase.end.upper - first, phase.duration.upper), shortest)
    about = guess.about if isinstance(guess, RandomGuess) else None
    wanted = getattr(guess, "duration", None) or getattr(about, "duration", None)
    if wanted is not None:
        return first, first + min(max(wanted, shortest), longest)
    if math.isinf(longest):
        duration = max(2 * shortest, 1.0)
    elif shortest > 0:
        duration = math.sqrt(shortest * longest)
    else:
        duration = longest / 2
    return first, first + (duration or 1e-3)


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
        ends = initial.lower, final.nearest(initial.lower)
    elif final.fixed:
        ends = initial.nearest(final.lower), final.lower
    else:
        ends = initial.nearest(0.0), final.nearest(0.0)
    return np.asarray(ends[0] + (ends[1] - ends[0]) * shares)
