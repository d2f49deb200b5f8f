"""The hand-assembled derivatives are those of CasADi's own differentiation of the whole."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from schemas.reading import read_problem
from solver.mesh import Mesh
from solver.nlp import kernel
from solver.nlp.assembly import Nlp, assemble
from solver.nlp.kept import forget
from solver.nlp.program import Program
from solver.nlp.scaling import typical_scaling
from solver.prepare import prepare
from solver.transcribe import transcribe
from tests.support.methods import variants
from tests.support.problems import cart_pole

METHODS = [
    *({**variant, "segments": 4} for variant in variants()),
    *({**variant, "segments": 1} for variant in variants()),
]
OBJECTIVES = [
    "effort",
    "2*effort + duration^2",
    "sqrt(1 + effort) + final.q1*effort",
    "final.q1",
]


def program_of(method: dict[str, Any], objective: str) -> Program:
    document = cart_pole() | {"method": method, "objective": {"minimize": objective}}
    document["phases"][0]["time"]["initial"] = [0, 0.05]
    problem = read_problem(document)
    model, setting = prepare(problem)
    knots = np.array([0.0, *np.sort(np.random.default_rng(1).random(method["segments"] - 1)), 1.0])
    mesh = Mesh(knots, Mesh.uniform(len(knots) - 1, setting.transcriptions[0].degree).degrees)
    return transcribe(model, replace(setting, meshes=[mesh])).program


@pytest.fixture(params=METHODS, ids=str)
def method(request: pytest.FixtureRequest) -> dict[str, Any]:
    return dict(request.param)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_derivatives(method: dict[str, Any], objective: str) -> None:
    program = program_of(method, objective)
    nlp = assemble(program, typical_scaling(program))
    rng = np.random.default_rng(0)
    z, lam = rng.random(program.variables.size) + 0.5, rng.standard_normal(program.rows)
    assert_gradient(nlp, z)
    assert_jacobian(nlp, z)
    assert_hessian(nlp, z, lam)


def test_derivatives_of_large_stages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Above a size nobody looks for equal parts; the numbers are the same."""
    forget()
    monkeypatch.setattr(kernel, "_SHARED", 0)
    test_derivatives({"kind": "hermite_simpson", "segments": 3}, OBJECTIVES[1])


def close(ours: ca.DM, theirs: ca.DM) -> None:
    np.testing.assert_allclose(ours.full(), theirs.full(), rtol=1e-10, atol=1e-10)


def assert_gradient(nlp: Nlp, z: Any) -> None:
    whole = ca.Function("whole", [nlp.symbols], [ca.gradient(nlp.objective, nlp.symbols)])
    close(nlp.gradient(z, [])[1], whole(z))


def assert_jacobian(nlp: Nlp, z: Any) -> None:
    whole = ca.Function("whole", [nlp.symbols], [ca.jacobian(nlp.rows, nlp.symbols)])
    close(nlp.jacobian(z, [])[1], whole(z))


def assert_hessian(nlp: Nlp, z: Any, lam: Any) -> None:
    lagrangian = 0.7 * nlp.objective + ca.dot(ca.DM(lam), nlp.rows)
    whole = ca.Function("whole", [nlp.symbols], [ca.triu(ca.hessian(lagrangian, nlp.symbols)[0])])
    close(nlp.hessian(z, [], 0.7, lam), whole(z))


def test_an_integral_with_a_constant_factor_needs_no_variable() -> None:
    assert program_of(METHODS[0], "2*effort + duration").sum_names == ()


def test_an_integral_under_a_root_is_lifted() -> None:
    assert program_of(METHODS[0], "sqrt(1 + effort)").sum_names == (("effort", 0),)


def test_every_row_has_a_label() -> None:
    program = program_of(METHODS[0], "sqrt(1 + effort)")
    labels = list(program.labels())
    assert len(labels) == program.rows
    assert {label.name for label in labels} >= {"defect q1", "path height", "boundary span"}
