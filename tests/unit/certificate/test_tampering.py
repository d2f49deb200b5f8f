"""A result that is wrong in one place fails the right check, and that says where."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.certificate import certify
from tests.support.exact import altered, block_problem, block_result, failures, result

Array = np.ndarray


def add(segment: int, term: int, amount: float) -> Callable[[Array], Array]:
    """Change one coefficient of one segment."""

    def change(rows: Array) -> Array:
        rows[segment, term] += amount
        return rows

    return change


def test_a_control_that_the_motion_does_not_follow() -> None:
    tampered = altered(block_result(), "controls", "u", add(2, 0, 0.01))
    failed = failures(certify(block_problem(), [tampered], 12.0))
    assert failed["interval defect"] == "phase move, v, t = 0.75 s"


def test_a_state_bent_between_its_knots() -> None:
    """T_2 - T_0 vanishes at both ends: only the inside of the segment is wrong."""

    def bend(rows: Array) -> Array:
        rows[1, 2] += 1e-3
        rows[1, 0] -= 1e-3
        return rows

    tampered = altered(block_result(), "states", "x", bend)
    failed = failures(certify(block_problem(), [tampered], 12.0))
    assert failed == {"interval defect": "phase move, x, t = 0.375 s"}


def test_a_jump_that_the_dynamics_cannot_see() -> None:
    def shift(rows: Array) -> Array:
        rows[2:, 0] += 1e-3
        return rows

    tampered = altered(block_result(), "states", "x", shift)
    failed = failures(certify(block_problem(final={"v": 0}), [tampered], 12.0))
    assert failed == {"continuity": "phase move, x, t = 0.5 s"}


@pytest.mark.parametrize("published", [12.01, None, math.nan])
def test_a_wrong_objective(published: float | None) -> None:
    certificate = certify(block_problem(), [block_result()], published)
    failed = failures(certificate)
    assert list(failed) == ["objective"]
    assert "recomputed 12" in str(failed["objective"])


@pytest.mark.parametrize(
    ("changes", "check", "where"),
    [
        ({"final": {"x": 1.01}}, "end values", "phase move, final.x"),
        ({"initial": {"v": [0.5, None]}}, "end values", "phase move, initial.v"),
        ({"initial": {"u": 0}}, "end values", "phase move, initial.u"),
        ({"time": {"initial": 0, "final": 1.1}}, "time", "phase move, final.t"),
        ({"time": {"initial": [0.1, 2], "final": 1}}, "time", "phase move, initial.t"),
        ({"bounds": {"v": [0, 1.4]}}, "state bounds", "phase move, v, t = 0.5 s"),
        ({"bounds": {"u": [-5, None]}}, "control overshoot", "phase move, u, t = 1 s"),
        (
            {"path": [{"name": "power", "expression": "u*v", "upper": 3}]},
            "path constraints",
            "phase move, power, t = 0.208333 s",
        ),
        (
            {"boundary": [{"name": "budget", "expression": "effort/duration", "upper": 11}]},
            "boundary constraints",
            "phase move, budget",
        ),
    ],
)
def test_a_limit_that_is_not_kept(changes: dict[str, Any], check: str, where: str) -> None:
    certificate = certify(block_problem(**changes), [block_result()], 12.0)
    assert failures(certificate) == {check: where}


def test_the_violation_is_relative_to_one_plus_the_limit() -> None:
    certificate = certify(block_problem(final={"x": 3}), [block_result()], 12.0)
    ends = next(row for row in certificate.checks if row.name == "end values")
    assert ends.value == pytest.approx(2 / 4)


def test_a_control_that_keeps_its_bounds_at_the_nodes_only() -> None:
    """u = 1 at both ends and the middle of a quadratic would be 1; here it swings to 1.125."""
    swing = {"u": lambda t: 1 + 4 * t * (0.5 - t) * np.sign(0.5 - t)}
    states = {"v": lambda t: t + np.where(t < 0.5, t**2 - 4 * t**3 / 3, 0), "x": lambda t: 0 * t}
    published = result(states, swing, np.array([0.0, 0.5]), 3, "move")
    problem = block_problem(bounds={"u": [-1, 1]}, time={"final": 0.5}, initial={}, final={})
    failed = failures(certify(problem, [published], 0.0))
    assert failed["control overshoot"] == "phase move, u, t = 0.25 s"


def slow_down(problem: Problem, derivative: str) -> Problem:
    document = problem.model_dump(mode="json")
    document["phases"][0]["system"]["derivatives"]["v"] = derivative
    return Problem.model_validate(document)


def test_dynamics_without_a_value_fail_with_null() -> None:
    problem = slow_down(block_problem(), "u + 0*sqrt(0.75 - x)")
    certificate = certify(problem, [block_result(8)], 12.0)
    assert list(failures(certificate)) == ["interval defect"]
    defect, *_, rollout = certificate.checks
    assert defect.value is None
    assert str(defect.where).startswith("phase move, v, t = ")
    assert rollout.value is None
    assert not rollout.passed


def test_a_motion_that_escapes_to_infinity_is_given_up() -> None:
    problem = slow_down(block_problem(), "u + 1e3*v^3 + 1e3")
    certificate = certify(problem, [block_result(1)], 12.0)
    assert "steps" in str(failures(certificate)["interval defect"])


def test_an_integral_without_a_value() -> None:
    problem = block_problem(integrals={"effort": "sqrt(0.5 - x)"})
    certificate = certify(problem, [block_result()], 12.0)
    assert list(failures(certificate)) == ["objective"]
    assert next(row for row in certificate.checks if row.name == "objective").value is None


def test_an_integral_that_cannot_be_trusted() -> None:
    problem = block_problem(integrals={"effort": "sin(1e60*t)"})
    failed = failures(certify(problem, [block_result()], 0.0))
    assert failed["objective"] == "phase move, integral effort: the quadrature does not settle"


def test_an_unstable_system_is_not_blamed_for_its_rollout() -> None:
    """v' = 40 v + ... amplifies a millionth beyond all measure, and every segment is fine."""
    problem = slow_down(block_problem(), "u + 40*(v - (6*t - 6*t^2))")
    tampered = altered(block_result(40), "states", "v", add(0, 0, 1e-7))
    certificate = certify(problem, [tampered], 12.0)
    assert certificate.verdict == "certified"
    assert (certificate.checks[-1].value or 0) > 1e6


def without(published: PhaseResult, group: str, name: str | None = None) -> PhaseResult:
    curves = dict(published.curves)
    curve = curves.pop(group)
    if name is not None:
        rest = {key: rows for key, rows in curve.coefficients.items() if key != name}
        curves[group] = curve.model_copy(update={"coefficients": rest})
    return published.model_copy(update={"curves": curves})


def stretched(published: PhaseResult) -> PhaseResult:
    controls = published.curves["controls"]
    longer = controls.model_copy(update={"breaks": [2 * time for time in controls.breaks]})
    return published.model_copy(update={"curves": {**published.curves, "controls": longer}})


@pytest.mark.parametrize(
    ("published", "reason"),
    [
        ([], "phase move has no result"),
        ([without(block_result(), "controls")], "there is no curve of u"),
        ([without(block_result(), "states", "v")], "there is no curve of v"),
        ([altered(block_result(), "states", "x", lambda rows: rows[1:])], "cannot be read"),
        ([stretched(block_result())], "same span"),
    ],
)
def test_curves_that_cannot_be_read(published: list[PhaseResult], reason: str) -> None:
    certificate = certify(block_problem(), published, 12.0)
    failed = failures(certificate)
    assert list(failed) == ["curves"]
    assert reason in str(failed["curves"])
