"""Exact pairs, and the kind of stationary point that they are at (Scheel and Scholtes, 2000)."""

from math import inf

import numpy as np
import pytest

from schemas.problem import SolverSettings
from solver.backends import NlpStatus, Outcome, Strategy, make_backend
from solver.backends.plugin import iterate_at
from solver.complementarity.homotopy import Relaxed
from solver.complementarity.polish import polish
from solver.complementarity.stationarity import label_of, stationarity
from solver.nlp.task import NlpTask
from tests.unit.complementarity.programs import Stated, pair, stated, watched

FREE = {"x": (0.0, 0.0, inf), "y": (0.0, 0.0, inf)}


def attempt(task: NlpTask, strategy: Strategy, *, warm: bool) -> Outcome:
    settings = SolverSettings()
    return make_backend("ipopt").solve(task, settings, watched(), warm=warm, strategy=strategy)


def at(problem: Stated, *values: float, rows: tuple[float, ...] = (0.0,)) -> Outcome:
    """A point with the multipliers of its rows, as if it had been found."""
    z = np.array([*values, 1e-7]) / problem.scaling.columns
    point = iterate_at(problem.task, z)
    return Outcome(NlpStatus.OPTIMAL, "", point, 1, 0.0, np.array(rows), np.zeros(len(z)))


@pytest.mark.parametrize(
    ("objective", "label"),
    [
        ("x + y", "strong"),
        ("x + y^2", "strong"),
        ("x^2 - y", "M"),
        ("-x - y", "C"),
        ("x - y", "weak"),
    ],
)
def test_the_label_of_a_biactive_point(objective: str, label: str) -> None:
    problem = stated(FREE, objective, [pair("x", "y")])
    found = stationarity(problem.task, problem.pairing, at(problem, 0.0, 0.0))
    assert found is not None
    assert found.label == label
    assert found.biactive.tolist() == [True]


def test_multipliers_of_rows_count_into_the_label() -> None:
    """With y = 2 x as a row its multiplier takes what the objective pulls at y."""
    problem = stated(FREE, "x - y", [pair("x", "y")], rows={"y - 2*x": (0, 0)})
    found = stationarity(problem.task, problem.pairing, at(problem, 0.0, 0.0, rows=(1.0, 0.0)))
    assert found is not None
    assert found.multipliers == pytest.approx(np.array([[-1.0, 0.0]]))
    assert found.label == "M"


def test_a_point_without_biactive_pairs_is_strong() -> None:
    problem = stated(FREE, "(x-1)^2 - y", [pair("x", "y")])
    found = stationarity(problem.task, problem.pairing, at(problem, 1.0, 0.0))
    assert found is not None
    assert found.label == "strong"
    assert found.multipliers == pytest.approx(np.array([[0.0, -1.0]]))


def test_the_worst_pair_gives_the_label() -> None:
    assert label_of(np.array([[1.0, 1.0], [0.0, -1.0]])) == "M"
    assert label_of(np.array([[-1.0, -1.0], [0.0, -1.0]])) == "C"
    assert label_of(np.array([[-1.0, -1.0], [1.0, -1.0]])) == "weak"
    assert label_of(np.zeros((0, 2))) == "strong"


def relaxed(problem: Stated) -> Relaxed:
    return Relaxed(problem.task, problem.pairing, "equality", np.array([False]))


def test_the_smaller_member_is_zero_exactly() -> None:
    problem = stated(FREE, "(x-1)^2 + (y-2)^2", [pair("x", "y")])
    found = polish(relaxed(problem), at(problem, 1.0, 1e-7), 1e-7, attempt)
    assert found.outcome is not None
    assert found.outcome.point.z[:2] == pytest.approx([1.0, 0.0], abs=1e-10)
    assert found.outcome.point.z[1] == 0.0
    assert found.stationarity is not None
    assert found.stationarity.label == "strong"


def test_the_sizes_say_which_one_is_smaller() -> None:
    problem = stated(FREE, "(x-1)^2 + y/1e4", [pair("x", "y", sizes=(1.0, 1000.0))])
    found = polish(relaxed(problem), at(problem, 0.1, 1.0), 1e-4, attempt)
    assert found.outcome is not None
    assert found.outcome.point.z[1] == 0.0


def test_a_point_that_only_looks_stationary_is_left() -> None:
    """From (0, 0) with x at zero y stays there, too; then x would rather grow: M at the best."""
    problem = stated(FREE, "(x-1)^2 + y", [pair("x", "y")])
    found = polish(relaxed(problem), at(problem, 0.0, 0.0), 1e-7, attempt)
    assert found.outcome is not None
    assert found.outcome.point.z[:2] == pytest.approx([1.0, 0.0], abs=1e-7)
    assert found.stationarity is not None
    assert found.stationarity.label == "strong"


def test_a_polish_without_a_solution_comes_to_nothing() -> None:
    problem = stated(FREE, "x + y", [pair("x", "y")], rows={"x": (1, inf), "y": (1, inf)})
    found = polish(relaxed(problem), at(problem, 1.0, 1.0, rows=(0.0,) * 3), 1.0, attempt)
    assert found.outcome is None
    assert found.over is None
    assert found.iterations > 0


def test_a_polish_that_goes_elsewhere_comes_to_nothing() -> None:
    """The row leaves x at zero only y = 5: dearer by far than what the homotopy had found."""
    problem = stated(FREE, "(x-1)^2 + 10*y", [pair("x", "y")], rows={"x + y/5": (1, 1)})
    found = polish(relaxed(problem), at(problem, 0.4, 0.5, rows=(0.0,) * 2), 0.2, attempt)
    assert found.outcome is None
