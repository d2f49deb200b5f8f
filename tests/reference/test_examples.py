"""Every example converges, certified, and meets what is known of its optimum."""

import json
from typing import Any

import pytest

import examples
from schemas.reading import read_problem
from schemas.results import Solution, SolutionStatus
from solver import solve
from tests.support.methods import label, variants


def found(solution: Solution, quantity: str) -> float:
    """The objective, or ``static.NAME``."""
    group, _, name = quantity.partition(".")
    value = solution.static[name] if name else getattr(solution, group)
    assert value is not None, f"{quantity}: {solution.message}"
    return value


@pytest.fixture(scope="module", params=examples.names())
def solved(request: pytest.FixtureRequest) -> tuple[dict[str, Any], Solution]:
    document = examples.load(request.param)
    return document, solve(read_problem(document))


def test_converges_with_a_certificate(solved: tuple[dict[str, Any], Solution]) -> None:
    _, solution = solved
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.certificate.verdict == "certified"
    assert solution.mesh_refinement.converged


def test_meets_what_is_known(solved: tuple[dict[str, Any], Solution]) -> None:
    document, solution = solved
    assert document["known"], "an example states what is known of its optimum"
    for known in document["known"]:
        value = found(solution, known["quantity"])
        error = abs(value - known["value"]) / max(1.0, abs(known["value"]))
        assert error <= known["tolerance"], f"{value} against {known['value']}"


def test_the_result_is_plain_json(solved: tuple[dict[str, Any], Solution]) -> None:
    _, solution = solved
    text = solution.model_dump_json()
    json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} in a result"))
    assert Solution.model_validate_json(text) == solution


@pytest.mark.parametrize(
    ("method", "objective"),
    [
        ({"kind": "hermite_simpson", "segments": 25, "form": "separated"}, 58.80542547),
        ({"kind": "hermite_simpson", "segments": 25, "form": "compressed"}, 58.80542547),
    ],
)
def test_cart_pole_on_the_papers_mesh(method: dict[str, Any], objective: float) -> None:
    """003, section 7.8: 25 Hermite-Simpson segments, one mesh."""
    document = examples.load("cart_pole") | {"method": method, "refinement": None}
    solution = solve(read_problem(document))
    assert solution.objective == pytest.approx(objective, abs=1e-7)


@pytest.mark.parametrize("method", variants(), ids=label)
def test_a_closed_form_under_every_method(method: dict[str, Any]) -> None:
    """003, section 7.7: the least force is 6 - 12 t, its integral of u^2 is 12.

    The coarsest is trapezoidal, 47 h^2 above: its own optimum, and its quadrature of a parabola.
    """
    changes = {"method": {**method, "segments": 100}, "refinement": {"tolerance": 1e-4}}
    solution = solve(read_problem(examples.load("block_min_force") | changes))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    assert solution.objective == pytest.approx(12, rel=5e-4)


def test_block_on_the_trapezoidal_mesh() -> None:
    """003, section 7.7: 25 trapezoidal segments give 12.0749614."""
    method = {"kind": "trapezoidal", "segments": 25}
    document = examples.load("block_min_force") | {"method": method, "refinement": None}
    assert solve(read_problem(document)).objective == pytest.approx(12.0749614, abs=1e-6)


SMOOTH = ["block_min_force", "cart_pole", "linear_quadratic", "pendulum_torque", "quadrotor"]
HIGH_ORDER = [
    {"kind": "radau", "segments": 15, "points": 5},
    {"kind": "chebyshev_lobatto", "degree": 40},
    {"kind": "multiple_shooting", "segments": 60},
]


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("method", HIGH_ORDER, ids=lambda method: method["kind"])
def test_every_method_meets_the_same_optimum(name: str, method: dict[str, Any]) -> None:
    document = examples.load(name) | {"method": method}
    solution = solve(read_problem(document))
    assert solution.status is SolutionStatus.CONVERGED, solution.message
    known = document["known"][0]["value"]
    assert solution.objective == pytest.approx(known, rel=1e-6)
