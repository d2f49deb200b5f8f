"""Numbers that the solver chooses: wherever they stand, and from where they start."""

import math
from typing import Any

import pytest

from schemas.errors import InvalidModel
from schemas.reading import read_problem
from solver.prepare import prepare
from tests.unit.solver.motions import COAST, move, problem
from tests.unit.solver.problems import solved

DECAY: dict[str, Any] = {
    "kind": "ode",
    "states": ["x"],
    "controls": ["u"],
    "derivatives": {"x": "u - k*x"},
}
METHODS: list[dict[str, Any]] = [
    {"kind": "trapezoidal", "segments": 400},
    {"kind": "hermite_simpson", "segments": 20},
    {"kind": "radau", "segments": 4},
    {"kind": "multiple_shooting", "segments": 20},
    {"kind": "chebyshev_lobatto", "degree": 14},
]


def decay(**changes: Any) -> dict[str, Any]:
    return move(system=DECAY, initial={"x": 1}, final={}, bounds={"u": 0}, **changes)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method["kind"])
def test_a_rate_is_found_from_a_curve(method: dict[str, Any]) -> None:
    """x follows exp(-2 t)."""
    misfit = decay(integrals={"misfit": "(x - exp(-2*t))^2"})
    document = problem(misfit, method=method, objective={"minimize": "misfit"})
    solution = solved(document | {"static": {"k": {"bounds": [0, 9]}}})
    assert solution.static["k"] == pytest.approx(2, rel=1e-4)


def test_a_rate_is_found_from_an_end() -> None:
    document = problem(decay(integrals={}), objective={"minimize": "(final.x - 0.5)^2"})
    solution = solved(document | {"static": {"k": {"bounds": [0, 9]}}})
    assert solution.static["k"] == pytest.approx(math.log(2), rel=1e-3)


def test_at_ends_alone() -> None:
    """One metre would be free of the second term, but costs 12: p = 1/13."""
    place = [{"name": "place", "expression": "final.q - p", "lower": 0, "upper": 0}]
    document = problem(
        move(final={"d(q)": 0}, boundary=place),
        objective={"minimize": "effort + (p - 1)^2"},
        static={"p": {"bounds": [-5, 5]}},
    )
    solution = solved(document)
    assert solution.objective == pytest.approx(12 / 13)
    assert solution.static["p"] == pytest.approx(1 / 13)


def test_the_same_in_all_phases() -> None:
    """A push to a speed p, a flight at a speed p."""
    rows = [{"name": "speed", "expression": "final.d(q) - p", "lower": 0, "upper": 0}]
    flight = {
        "name": "coast",
        "system": COAST,
        "time": {"duration": 1},
        "initial": {"q": 0},
        "final": {"q": 0.5},
        "boundary": [{"name": "speed", "expression": "initial.v - p", "lower": 0, "upper": 0}],
        "integrals": {},
    }
    push = move("push", final={}, boundary=rows)
    solution = solved(problem(push, flight, static={"p": {"bounds": [-5, 5]}}))
    assert solution.static["p"] == pytest.approx(0.5)
    assert solution.objective == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("static", "guess"),
    [
        ({"bounds": [2, 6]}, 4),
        ({"bounds": [2, None]}, 2),
        ({"bounds": [None, None]}, 1),
        ({"bounds": [2, 6], "guess": "3/2 + 1"}, 2.5),
        ({"bounds": 3}, 3),
    ],
)
def test_from_where_they_start(static: dict[str, Any], guess: float) -> None:
    _, setting = prepare(read_problem(problem(decay(), static={"k": static})))
    assert setting.statics == [guess]


def test_the_start_that_breaks_is_the_guess_of_the_statics() -> None:
    """The static's own guess would do; that of the solution it starts from does not."""
    integrals = {"misfit": "sqrt(k) + x^2"}
    guess = {"kind": "solution", "phases": [{"name": "move", "curves": {}}], "static": {"k": -1}}
    document = problem(decay(integrals=integrals), objective={"minimize": "misfit"}, guess=guess)
    with pytest.raises(InvalidModel) as refused:
        solved(document | {"static": {"k": {"bounds": [-2, 9], "guess": 4}}})
    assert refused.value.issues[0].pointer.endswith("/integrals/misfit")
