"""Random guesses: smooth, within the bounds, the same for the same seed."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.guesses import LinearGuess
from schemas.reading import read_problem
from solver.model import Interval, Phase
from solver.prepare import prepare
from solver.trajectory import Trajectory, initial_guesses
from solver.trajectory.noise import noisy, noisy_values
from tests.unit.solver.problems import block

TIMES = np.linspace(0.0, 1.0, 401)


def guessed(**phase: Any) -> tuple[Phase, Trajectory]:
    """The block's phase and its linear guess."""
    model, _ = prepare(read_problem(block(phase=phase)))
    return model.phases[0], initial_guesses(model, [LinearGuess()])[0]


def sampled(trajectory: Trajectory) -> dict[str, Any]:
    """Every series at fractions of the trajectory."""
    times = trajectory.start + (trajectory.end - trajectory.start) * TIMES
    return trajectory.states.sample(times) | trajectory.controls.sample(times)


def test_the_same_seed_gives_the_same_guess() -> None:
    phase, linear = guessed()
    one, two, other = (sampled(noisy(linear, phase, seed, 0.3)) for seed in (5, 5, 6))
    for name in one:
        np.testing.assert_array_equal(one[name], two[name])
        assert np.ptp(one[name] - other[name]) > 0.05


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**31), st.floats(0.01, 10))
def test_bounds_hold_and_known_ends_stay(seed: int, spread: float) -> None:
    phase, linear = guessed(bounds={"x": [-0.2, 1.1], "u": [-3, None]}, final={"x": 1})
    values = sampled(noisy(linear, phase, seed, spread))
    assert values["x"].min() >= -0.2 - 1e-12
    assert values["x"].max() <= 1.1 + 1e-12
    assert values["u"].min() >= -3 - 1e-12
    np.testing.assert_allclose([values["x"][0], values["v"][0], values["x"][-1]], [0, 0, 1])


def test_the_noise_has_the_size_that_was_asked_for() -> None:
    phase, linear = guessed(bounds={"u": [-100, 100]})
    before = sampled(linear)
    size = {"x": 1.0, "v": 1.0, "u": 200.0}
    gaps = [sampled(noisy(linear, phase, seed, 0.02)) for seed in range(200)]
    middle = len(TIMES) // 3
    for name, typical in size.items():
        noise = [values[name][middle] - before[name][middle] for values in gaps]
        assert 0.5 < np.std(noise) / (0.02 * typical) < 1.5


def test_the_noise_is_smooth() -> None:
    phase, linear = guessed()
    for seed in range(20):
        noise = sampled(noisy(linear, phase, seed, 0.25))["u"]
        assert np.max(np.abs(np.diff(noise))) < 0.05 * (np.ptp(noise) + 1)


def test_a_free_duration_varies_within_its_limits() -> None:
    phase, linear = guessed(time={"initial": 0, "final": [0.5, 2]})
    ends = [noisy(linear, phase, seed, 1.0).end for seed in range(200)]
    assert min(ends) >= 0.5
    assert max(ends) == 2
    assert np.std(ends) > 0.2


def test_a_fixed_duration_stays() -> None:
    phase, linear = guessed()
    assert noisy(linear, phase, 3, 1.0).end == linear.end


def test_values_stay_within_their_limits() -> None:
    limits = [Interval(0, 1), Interval(2, 2), Interval(-np.inf, np.inf)]
    draws = np.array([noisy_values([0.5, 2, 10], limits, seed, 0.5) for seed in range(100)])
    assert draws[:, 0].min() == 0
    assert draws[:, 0].max() == 1
    assert np.all(draws[:, 1] == 2)
    assert np.std(draws[:, 2]) == pytest.approx(5, rel=0.3)
