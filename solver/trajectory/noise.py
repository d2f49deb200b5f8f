"""Random guesses: smooth noise within the bounds, the same for the same seed."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.model import Interval, Phase
from solver.trajectory.trajectory import Trajectory, straight_lines

Array = NDArray[np.float64]

MODES = 3
"""Half waves of the noise at the most, sines and cosines; mode k has the size 1 / k."""

PIECES = 48
"""Straight pieces of a noisy curve, which stay within bounds between their ends, too."""


def noisy(trajectory: Trajectory, phase: Phase, seed: int, spread: float) -> Trajectory:
    """A trajectory with smooth noise on all states and controls, and on its duration.

    The noise of a series has a standard deviation of ``spread`` times the width of its bounds,
    or times its typical size where a side is open: the largest of 1, the guess and the limits.
    Values stay within the bounds, known ends as they are. A free duration is multiplied by a
    log-normal factor of the same spread, within its limits. Give each phase its own seed.
    """
    rng = np.random.default_rng(seed)
    longest = min(phase.end.upper - trajectory.start, phase.duration.upper)
    shortest = max(phase.end.lower - trajectory.start, phase.duration.lower, 0.0)
    length = trajectory.end - trajectory.start
    factor = math.exp(spread * float(rng.normal()))
    if longest > shortest:
        length = min(max(length * factor, shortest + 0.01 * (length - shortest)), longest)
    before = np.linspace(trajectory.start, trajectory.end, PIECES + 1)
    times = np.linspace(trajectory.start, trajectory.start + length, PIECES + 1)
    groups = []
    for curves in (trajectory.states, trajectory.controls):
        rows = [_row(phase, name, curve(before), rng, spread) for name, curve in curves.items()]
        values = np.array(rows).reshape(len(rows), len(times))
        groups.append(straight_lines(list(curves), times, values))
    return Trajectory(trajectory.start, trajectory.start + length, *groups)


def noisy_values(
    values: Sequence[float], limits: Sequence[Interval], seed: int, spread: float
) -> list[float]:
    """Values with noise, each within its limits; for static parameters."""
    draws = np.random.default_rng([seed, 1]).normal(size=len(values))
    return [
        interval.nearest(value + spread * _scale(interval, value) * float(draw))
        for value, interval, draw in zip(values, limits, draws, strict=True)
    ]


def _row(phase: Phase, name: str, values: Array, rng: np.random.Generator, spread: float) -> Array:
    """One series with noise: within its bounds but for known ends, which keep their values."""
    limits = phase.bounds.get(name, _OPEN)
    fixed = [ends.get(name, _OPEN).fixed for ends in (phase.initial, phase.final)]
    shares = np.linspace(0.0, 1.0, len(values))
    noise = _smooth(shares, rng) * spread * _scale(limits, values)
    noise -= noise[0] * (1 - shares) * fixed[0] + noise[-1] * shares * fixed[1]
    shaken = np.clip(values + noise, *limits)
    kept = [place for place, known in zip((0, -1), fixed, strict=True) if known]
    shaken[kept] = values[kept]
    return np.asarray(shaken)


def _smooth(shares: Array, rng: np.random.Generator) -> Array:
    """A random function of shares of the phase, of standard deviation 1 at each of them."""
    modes = np.arange(1, MODES + 1)
    sines, cosines = rng.normal(size=(2, MODES)) / modes
    waves = np.pi * np.outer(shares, modes)
    total = np.sqrt(np.sum(1.0 / modes**2))
    return np.asarray((np.sin(waves) @ sines + np.cos(waves) @ cosines) / total)


_OPEN = Interval(-math.inf, math.inf)


def _scale(limits: Interval, values: Array | float) -> float:
    """What ``spread`` is relative to."""
    if math.isfinite(limits.upper - limits.lower):
        return limits.upper - limits.lower
    sizes = [abs(limit) for limit in limits if math.isfinite(limit)]
    return max(1.0, *sizes, float(np.max(np.abs(values))))
