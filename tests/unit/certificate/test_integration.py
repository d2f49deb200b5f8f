"""The independent integrator is as accurate as it says, also for one bad segment of many."""

import numpy as np
import pytest

from schemas.reading import read_problem
from solver.certificate.case import Case
from solver.certificate.dynamics import PLACES, _integrated
from solver.certificate.integration import Integrator, Unfinished
from tests.support.exact import result


def test_it_is_accurate_in_one_step_or_in_many() -> None:
    end = Integrator(1e-10).advance(lambda t, y: np.array([y[1], -y[0]]), 0, np.array([0, 1.0]), 9)
    assert end == pytest.approx([np.sin(9), np.cos(9)], abs=1e-8)


def test_one_hard_segment_among_many_easy_ones() -> None:
    """scipy's error norm is a mean: without a share for every segment this is 50 times worse."""
    segments, hard, pace = 900, 123, 40.0
    problem = read_problem(
        {
            "phases": [
                {
                    "system": {
                        "kind": "ode",
                        "states": ["x", "pace"],
                        "derivatives": {"x": "pace*cos(pace*t)", "pace": "0"},
                    },
                    "time": {"initial": 0, "final": segments},
                }
            ]
        }
    )
    breaks = np.linspace(0, segments, segments + 1)
    paces = np.where(np.arange(segments) == hard, pace, 1e-3)
    states = {"x": lambda t: 0 * t, "pace": lambda t: paces[t.astype(int)]}
    phase = Case.open(problem, [result(states, {}, breaks, 0)], None, {}).curved[0]
    start = phase.curves.states.grid(PLACES)[:, :, 0]
    motion = _integrated(phase, start, 1e-7)
    exact = np.sin(paces * breaks[1:]) - np.sin(paces * breaks[:-1])
    assert np.max(np.abs(motion[0, :, -1] - exact)) < 1e-11


def test_a_budget_ends_what_would_never_end() -> None:
    integrator = Integrator(1e-10, evaluations=500)
    with pytest.raises(Unfinished, match="too many steps") as stopped:
        integrator.advance(lambda t, y: -1e7 * (y - np.cos(t)), 0.0, np.array([2.0]), 1.0)
    assert 0 < stopped.value.at < 1


def test_a_start_without_a_rate_is_named() -> None:
    with pytest.raises(Unfinished, match="no finite value") as stopped:
        Integrator(1e-10).advance(lambda _, y: y * np.nan, 0.0, np.array([2.0]), 1.0)
    assert stopped.value.at == 0.0
