"""The initial guess."""

from typing import Any

import numpy as np
import pytest

from schemas.reading import read_problem
from solver.model import build_model
from solver.trajectory import Trajectory, initial_guesses
from tests.unit.solver.problems import block

STATES = ("x", "v")


def guessed(**changes: Any) -> Trajectory:
    problem = read_problem(block(**changes))
    return initial_guesses(build_model(problem), [problem.guess])[0]


def test_straight_lines_between_the_ends() -> None:
    guess = guessed(guess={"kind": "linear"})
    lines = np.array([[0.0, 0.25, 1.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(guess.sample(STATES, np.array([0, 0.25, 1])), lines)


def test_an_open_end_takes_the_other() -> None:
    guess = guessed(guess={"kind": "linear"}, phase={"initial": {"x": 2}, "final": {"v": 3}})
    np.testing.assert_allclose(guess.sample(STATES, np.array([0, 1])), [[2, 2], [3, 3]])


def test_two_open_ends_are_near_zero_within_the_bounds() -> None:
    guess = guessed(guess={"kind": "linear"}, phase={"bounds": {"u": [2, 5]}})
    np.testing.assert_allclose(guess.sample(["u"], np.array([0.5])), [[2]])


def test_constants_and_points() -> None:
    constant = guessed(guess={"kind": "constant", "values": {"u": "pi"}})
    np.testing.assert_allclose(constant.sample(["u"], np.array([0, 1])), [[np.pi, np.pi]])
    points = {"kind": "points", "time": [0, 1, 4], "values": {"x": [0, 2, 1]}}
    guess = guessed(guess=points)
    np.testing.assert_allclose(guess.sample(STATES, np.array([0, 0.125, 0.25]))[0], [0, 1, 2])


@pytest.mark.parametrize(
    ("final", "end"), [([0.1, 10], 1.0), ([4, None], 8.0), ([None, 10], 5.0), (3, 3.0)]
)
def test_a_free_time_is_guessed_within_its_limits(final: Any, end: float) -> None:
    guess = guessed(phase={"time": {"initial": 0, "final": final}})
    assert guess.start == 0
    assert guess.end == pytest.approx(end)
