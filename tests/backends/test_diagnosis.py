"""What is told of a program: what cannot be met, badly scaled, unused, without a value."""

from typing import Any

import numpy as np
import pytest

import examples
from schemas.problem import SolverSettings
from solver.backends import NlpStatus, make_backend
from solver.nlp.elastic import elastic
from solver.nlp.health import scale_warnings, unused_warnings
from solver.nlp.invalid import find_invalid
from solver.nlp.residuals import RowResidual
from solver.solving.unmet import unmet
from tests.backends.tasks import INFEASIBLE, after, posed, run, watched
from tests.unit.solver.problems import block


def found(document: dict[str, Any], backend: str = "ipopt") -> list[RowResidual] | None:
    _, program, scaling, task = posed(document)
    settings = SolverSettings(max_iterations=300)
    return unmet(make_backend(backend), settings, watched(), program, scaling, task)


@pytest.mark.parametrize("backend", ["ipopt", "uno"])
def test_a_force_too_small_misses_the_end(backend: str) -> None:
    """Full force either way for half a second each: 3/4 m, less what blurs the switch."""
    rows = found(INFEASIBLE, backend)
    assert rows is not None
    assert [(row.name, row.fraction) for row in rows] == [("bound x", 1.0)]
    assert rows[0].value == pytest.approx(0.25, abs=0.01)


def test_two_constraints_that_contradict_each_other() -> None:
    limits = [
        {"name": "low", "expression": "v", "upper": 1.3},
        {"name": "fast", "expression": "final.x - initial.x", "lower": 2},
    ]
    rows = found(block(phase={"path": limits[:1], "boundary": limits[1:]}))
    assert rows is not None
    names = {row.name for row in rows}
    assert names <= {"boundary fast", "path low", "bound x"}
    assert "boundary fast" in names or "bound x" in names


def test_what_can_be_met_has_nothing_unmet() -> None:
    assert found(examples.load("cart_pole")) == []


def test_a_stop_or_a_backend_that_refuses_leaves_it_open() -> None:
    _, program, scaling, task = posed(INFEASIBLE)
    arguments = (SolverSettings(), watched(should_stop=after(1)), program, scaling, task)
    assert unmet(make_backend("ipopt"), *arguments) is None
    assert unmet(make_backend("fatrop"), *arguments) is None


def test_derivatives_of_an_elastic_program() -> None:
    _, _, _, task = posed(INFEASIBLE)
    rows = np.arange(len(task.row_lower)) % 2 == 0
    relaxed = elastic(task, rows, np.ones(len(task.start), dtype=bool)).task
    random = np.random.default_rng(1)
    y = relaxed.start + 0.1 * random.standard_normal(len(relaxed.start))
    lam, step = random.standard_normal(len(relaxed.row_lower)), 1e-6

    def lagrangian(at: np.ndarray) -> float:
        objective, values = relaxed.nlp.evaluate(at)
        return 0.7 * float(objective) + float(lam @ values.full().ravel())

    def slope(at: np.ndarray) -> np.ndarray:
        gradient = relaxed.nlp.gradient(at, [])[1].full().ravel()
        jacobian = relaxed.nlp.jacobian(at, [])[1].sparse()
        return np.asarray(0.7 * gradient + jacobian.T @ lam)

    steps = step * np.eye(len(y))
    numeric = [(lagrangian(y + e) - lagrangian(y - e)) / (2 * step) for e in steps]
    assert slope(y) == pytest.approx(np.array(numeric), abs=1e-6)
    upper = relaxed.nlp.hessian(y, [], 0.7, lam).full()
    whole = upper + np.triu(upper, 1).T
    numeric = [(slope(y + e) - slope(y - e)) / (2 * step) for e in steps]
    assert whole == pytest.approx(np.array(numeric), abs=1e-6)


def test_an_elastic_program_starts_feasible_and_ends_at_a_vanishing_sum() -> None:
    _, _, _, task = posed(block())
    relaxed = elastic(
        task, np.ones(len(task.row_lower), dtype=bool), np.zeros(len(task.start), dtype=bool)
    )
    values = relaxed.task.nlp.evaluate(relaxed.task.start)[1].full().ravel()
    assert relaxed.task.violation(values, relaxed.task.start) <= 1e-12
    outcome = run("ipopt", relaxed.task)
    assert outcome.status is NlpStatus.OPTIMAL
    z = relaxed.point(outcome.point.z)
    assert task.violation(task.nlp.evaluate(z)[1].full().ravel()) <= 1e-6


def test_badly_scaled_rows_and_variables_are_named() -> None:
    system = {"derivatives": {"x": "v", "v": "1e9*u"}}
    _, program, _, task = posed(block(system=system))
    lines = scale_warnings(program, task, ["push"])
    assert [line.split(" is badly scaled")[0] for line in lines] == [
        "'defect v' in phase push",
        "'u' in phase push",
    ]


@pytest.mark.parametrize("name", examples.names())
def test_the_gallery_is_scaled_and_used(name: str) -> None:
    problem, program, _, task = posed(examples.load(name))
    phases = [phase.name for phase in problem.phases]
    assert scale_warnings(program, task, phases) == []
    assert unused_warnings(program, task, phases) == []


def test_unused_controls_are_named() -> None:
    system = {"controls": ["u", "idle"]}
    _, program, _, task = posed(block(system=system))
    lines = unused_warnings(program, task, ["push"])
    assert [line.split(" has no effect")[0] for line in lines] == ["'idle' in phase push"]


def test_a_control_in_the_objective_alone_is_used() -> None:
    phase = {"integrals": {"effort": "u^2 + spare^2"}}
    _, program, _, task = posed(block(system={"controls": ["u", "spare"]}, phase=phase))
    assert unused_warnings(program, task, ["push"]) == []


def test_what_has_no_value_beside_a_point_is_named() -> None:
    system = {"derivatives": {"x": "v", "v": "u + sqrt(1.001 - v)"}}
    _, program, _, task = posed(block(system=system))
    labels = find_invalid(program, task, task.start)
    assert labels
    assert {(label.name, label.phase) for label in labels} <= {("defect v", 0), ("defect x", 0)}


def test_where_all_has_values_nothing_is_named() -> None:
    _, program, _, task = posed(block())
    assert find_invalid(program, task, task.start) == []
