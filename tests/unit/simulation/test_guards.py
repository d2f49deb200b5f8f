"""Roots of guards along a step."""

from collections.abc import Callable

import numpy as np
import pytest

from solver.numeric import Array
from solver.simulation.guards import Sampling, first_crossing

ABOVE = np.array([True])


def only(function: Callable[[Array], Array]) -> Callable[[Array], Array]:
    return lambda t: function(t)[None]


def test_a_root_is_found_to_the_last_digit() -> None:
    crossing, _ = first_crossing(only(np.cos), (0.0, 3.0), ABOVE, Sampling(0.5))
    assert crossing is not None
    assert crossing.time == pytest.approx(np.pi / 2, abs=1e-15)
    assert crossing.fired == (0,)


def test_the_first_of_several_guards_fires() -> None:
    def guards(t: Array) -> Array:
        return np.array([1.0 - t, np.cos(3 * t), 0.7 - t])

    crossing, _ = first_crossing(guards, (0.0, 2.0), np.ones(3, dtype=bool), Sampling(1.0))
    assert crossing is not None
    assert crossing.fired == (1,)
    assert crossing.time == pytest.approx(np.pi / 6, abs=1e-15)


def test_guards_that_fall_together_fire_together() -> None:
    crossing, _ = first_crossing(
        lambda t: np.array([1 - t, 2 - 2 * t]), (0.0, 3.0), np.ones(2, dtype=bool), Sampling(0.7)
    )
    assert crossing is not None
    assert crossing.fired == (0, 1)


def test_a_dip_between_two_samples_is_seen() -> None:
    # Below zero for 2e-4 only, at samples 0.1 apart.
    crossing, _ = first_crossing(
        only(lambda t: (t - 0.537) ** 2 - 1e-8), (0.0, 1.0), ABOVE, Sampling(0.1)
    )
    assert crossing is not None
    assert crossing.time == pytest.approx(0.5369, abs=1e-12)


def test_a_dip_that_stays_above_is_none() -> None:
    crossing, above = first_crossing(
        only(lambda t: (t - 0.537) ** 2 + 1e-8), (0.0, 1.0), ABOVE, Sampling(0.1)
    )
    assert crossing is None
    assert above[0]


def test_the_side_at_the_start_is_what_is_said() -> None:
    rising = only(lambda t: t - 0.5)
    assert first_crossing(rising, (0.0, 1.0), ~ABOVE, Sampling(0.1))[0] is None
    crossing, _ = first_crossing(rising, (0.0, 1.0), ABOVE, Sampling(0.1))
    assert crossing is not None
    assert crossing.time < 1e-12


@pytest.mark.parametrize("speed", [1e-2, 1e-4, 1e-6])
def test_the_first_small_arc_after_a_bounce_is_seen(speed: float) -> None:
    crossing, _ = first_crossing(
        only(lambda t: speed * t - 4.905 * t**2), (0.0, 1.0), ABOVE, Sampling(0.01, early=True)
    )
    assert crossing is not None
    assert crossing.time == pytest.approx(speed / 4.905, rel=1e-9)


def test_a_coarse_look_misses_what_a_fine_one_sees() -> None:
    def hills(t: Array) -> Array:
        return 0.2 - np.exp(20 * (np.cos(2 * np.pi * (t - 0.031) / 0.7) - 1))

    missed, _ = first_crossing(only(hills), (0.35, 1.05), ABOVE, Sampling(0.7))
    seen, _ = first_crossing(only(hills), (0.35, 1.05), ABOVE, Sampling(0.01))
    assert missed is None
    assert seen is not None
