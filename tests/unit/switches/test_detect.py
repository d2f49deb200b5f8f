"""Switches are found where there are some, and nowhere else."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from schemas.results import PhaseResult
from solver.lowering import lower
from solver.switches.detect import detect
from solver.switches.samples import Samples
from tests.unit.switches.curves import problem, published

Array = NDArray[np.float64]


def found(result: PhaseResult, **phase: Any) -> list[float]:
    """The switches of a result of the double integrator."""
    posed = problem(**phase)
    samples = Samples.of(lower(posed)[0], result, {})
    assert samples is not None
    return detect(posed.phases[0], samples)


def bang(switch: float) -> Callable[[Array], Array]:
    """Full force, then full brake."""
    return lambda t: np.where(t < switch, 1.0, -1.0)


@pytest.mark.parametrize("switch", [0.92, 1.0, 1.03, 1.049])
def test_bang_bang_is_one_switch(switch: float) -> None:
    assert found(published(bang(switch))) == [pytest.approx(switch, abs=0.05)]


def test_the_centroid_keeps_the_integral() -> None:
    """Over two segments of a tenth of a second the control falls from 1 to -1."""

    def smeared(t: Array) -> Array:
        return np.interp(t, [0.9, 1.0, 1.1], [1.0, -0.5, -1.0])

    # The means of the segments that it crosses are 0.25 and -0.75, above the lower limit of -1.
    balance = 0.9 + 0.1 * ((0.25 + 1) + (-0.75 + 1)) / 2
    assert found(published(smeared)) == [pytest.approx(balance, abs=1e-9)]


def test_jumps_without_bounds() -> None:
    result = published(bang(1.0))
    assert found(result, bounds={}) == [pytest.approx(1.0, abs=0.05)]


def test_bang_singular_bang() -> None:
    def control(t: Array) -> Array:
        return np.where(t < 0.6, 1.0, np.where(t < 1.4, 0.1, -1.0))

    assert found(published(control, 40)) == pytest.approx([0.6, 1.4], abs=0.03)


def test_a_smooth_control_that_saturates() -> None:
    def control(t: Array) -> Array:
        return np.clip(1.5 * np.sin(np.pi * t), -1, 1)

    first = np.arcsin(1 / 1.5) / np.pi
    kinks = [first, 1 - first, 1 + first, 2 - first]
    assert found(published(control, 40)) == pytest.approx(kinks, abs=0.03)


@pytest.mark.parametrize("segments", [6, 10, 25, 100])
def test_smooth_controls_have_none(segments: int) -> None:
    def control(t: Array) -> Array:
        return 0.9 * np.cos(2 * t) * np.exp(-t)

    assert found(published(control, segments)) == []


def test_noise_is_no_switch() -> None:
    noise = np.random.default_rng(1).normal(size=10_000)

    def control(t: Array) -> Array:
        return 0.3 + 1e-6 * noise[np.round(100 * t).astype(int)]

    assert found(published(control)) == []


def test_chatter_is_no_set_of_switches() -> None:
    assert found(published(lambda t: np.sign(np.sin(40 * t)), 200)) == []


def test_a_state_that_stays_on_its_bound() -> None:
    def state(t: Array) -> Array:
        return np.clip(2 - 3 * np.abs(t - 1), None, 1)  # at 1 from 2/3 to 4/3

    result = published(np.cos, 30, state)
    times = found(result, bounds={"x": [None, 1]})
    assert times == pytest.approx([2 / 3, 4 / 3], abs=0.04)


def test_a_path_constraint_over_an_intermediate() -> None:
    def state(t: Array) -> Array:
        return np.clip(2 - 3 * np.abs(t - 1), None, 1)

    row = {"name": "height", "expression": "twice", "upper": 2}
    system = problem().phases[0].system.model_dump() | {"define": {"twice": "2*x"}}
    times = found(published(np.cos, 30, state), path=[row], system=system, bounds={})
    assert times == pytest.approx([2 / 3, 4 / 3], abs=0.04)


def test_a_bound_that_is_touched_is_no_switch() -> None:
    result = published(np.cos, 30, lambda t: 1 - (t - 1) ** 2)
    assert found(result, bounds={"x": [None, 1]}) == []


def test_what_abs_turns_on_in_an_integral() -> None:
    def power(t: Array) -> Array:
        return np.interp(t, [0, 0.7, 1.3, 2.0], [-1, 0, 0, 1])

    integrals = {"work": "abs(p)"}
    system = problem().phases[0].system.model_dump() | {"define": {"p": "2*x"}}
    result = published(np.ones_like, 40, power)
    times = found(result, integrals=integrals, system=system, bounds={})
    assert times == pytest.approx([0.7, 1.3], abs=0.03)
    assert found(result, integrals={"work": "p^2"}, system=system, bounds={}) == []


def test_what_max_compares() -> None:
    result = published(np.ones_like, 40, lambda t: t - 0.8)
    times = found(result, integrals={"work": "max(x, 0.1)"}, bounds={})
    assert times == [pytest.approx(0.9, abs=0.03)]


def test_a_switch_next_to_an_end_is_left_alone() -> None:
    assert found(published(bang(0.05), 20)) == []


def test_a_slope_on_few_segments_is_no_jump() -> None:
    means = np.array([-1.58, -1.9, -0.96, 0.63, 1.9, 2.0, 1.42, 0.6, 0.03, -0.58])

    def control(t: Array) -> Array:
        return np.interp(t, 0.1 + 0.2 * np.arange(10), means)

    assert found(published(control, 10), bounds={}) == []


def test_without_kinks_only_jumps_are_told() -> None:
    def control(t: Array) -> Array:
        return np.where(t < 0.5, -1.0, np.clip(2 * t - 1.5, -1, 1))

    samples = Samples.of(lower(problem())[0], published(control, 40), {})
    assert samples is not None
    phase = problem().phases[0]
    assert detect(phase, samples) == pytest.approx([0.5, 1.25], abs=0.05)
    assert detect(phase, samples, kinks=False) == [pytest.approx(0.5, abs=0.05)]
