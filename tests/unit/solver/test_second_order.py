"""Second-order systems and derivatives by name, under every method; against paper."""

from typing import Any

import pytest

from schemas.errors import BadProblem, InvalidModel
from schemas.results import SolutionStatus
from tests.support.methods import label, variants
from tests.unit.solver.motions import EXPLICIT, IMPLICIT, move, problem
from tests.unit.solver.problems import solved

SYSTEMS = pytest.mark.parametrize("system", [EXPLICIT, IMPLICIT], ids=["explicit", "implicit"])


@pytest.fixture(params=variants(second_order=True), ids=label)
def method(request: pytest.FixtureRequest) -> dict[str, Any]:
    return {"segments": 1 if request.param["kind"] == "chebyshev_lobatto" else 16, **request.param}


@SYSTEMS
def test_the_least_rate_of_the_force(method: dict[str, Any], system: dict[str, Any]) -> None:
    """q is the quintic 10 t^3 - 15 t^4 + 6 t^5; the integral of its jerk squared is 720."""
    at_rest = {"q": 0, "d(q)": 0, "dd(q)": 0}
    phase = move(
        system=system,
        initial=at_rest,
        final={**at_rest, "q": 1},
        integrals={"effort": "d(u)^2"},
    )
    solution = solved(problem(phase, method=method))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(720, rel=1e-1)
    groups = solution.phases[0].groups
    assert set(groups["states"].values) == {"q", "d(q)"}
    assert set(groups["controls"].values) == {"u"}
    assert groups["controls"].values["u"][0] == pytest.approx(0, abs=1e-6)
    if "costates" in groups:
        assert set(groups["costates"].values) <= {"q", "d(q)"}
        assert groups["costates"].time == sorted(groups["costates"].time)


@SYSTEMS
def test_a_bound_on_the_rate_of_the_force(method: dict[str, Any], system: dict[str, Any]) -> None:
    """The force falls at 12 N/s from 6 N to -6 N: a bound of 15 N/s is none."""
    solution = solved(problem(move(system=system, bounds={"d(u)": [-15, 15]}), method=method))
    assert solution.objective == pytest.approx(12, rel=0.12)


@SYSTEMS
def test_a_bound_on_the_acceleration(method: dict[str, Any], system: dict[str, Any]) -> None:
    """From rest to rest at most at 4 m/s^2: bang-bang, 2 sqrt(d/a) = 1 s."""
    phase = move(system=system, time={"final": [0.1, 9]}, bounds={"dd(q)": [-4, 4]})
    document = problem(phase, method=method, objective={"minimize": "duration"})
    solution = solved(document)
    assert solution.status in (SolutionStatus.CONVERGED, SolutionStatus.CERTIFICATE_FAILED)
    assert solution.objective == pytest.approx(1, abs=0.06)


@SYSTEMS
def test_a_switch_on_a_knot_is_exact(system: dict[str, Any]) -> None:
    phase = move(system=system, time={"final": [0.1, 9]}, bounds={"dd(q)": [-4, 4]})
    even = {"kind": "radau", "segments": 2, "points": 3}
    solution = solved(problem(phase, method=even, objective={"minimize": "duration"}))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(1, rel=1e-6)


def test_least_fuel_by_slacks() -> None:
    """At 5 N at most over 0.8 m: push for 0.2 s, coast, brake; |u| adds up to 2."""
    phase = move(bounds={"u": [-5, 5]}, final={"q": 0.8, "d(q)": 0}, integrals={"effort": "abs(u)"})
    even = {"kind": "radau", "segments": 5, "points": 3}
    solution = solved(problem(phase, method=even, nonsmooth={"abs": "slack"}))
    assert solution.objective == pytest.approx(2, rel=1e-6)
    assert set(solution.phases[0].groups["controls"].values) == {"u"}


@pytest.mark.parametrize("end", ["initial", "final"])
@pytest.mark.parametrize("points", [2, 4, 5, 9])
def test_a_force_that_is_given_at_an_end(end: str, points: int) -> None:
    """At either end of every number of Radau points, of which the last one is the knot."""
    phase = move()
    phase[end] = {**phase[end], "u": 0}
    method = {"kind": "radau", "segments": 3, "points": points}
    solution = solved(problem(phase, method=method))
    at = 0 if end == "initial" else -1
    assert solution.phases[0].groups["controls"].values["u"][at] == pytest.approx(0, abs=1e-8)
    assert solution.objective is not None
    assert solution.objective > 12.1


def test_a_path_constraint_holds_at_the_start() -> None:
    """Where Radau has no control of its own."""
    path = [{"name": "force", "expression": "u", "lower": -4.5, "upper": 4.5}]
    method = {"kind": "radau", "segments": 7, "points": 3}
    solution = solved(problem(move(path=path), method=method))
    first = solution.phases[0].groups["controls"].values["u"][0]
    assert first == pytest.approx(4.5, abs=1e-6)


def test_an_open_bound_on_a_derivative_is_none() -> None:
    solution = solved(problem(move(bounds={"dd(q)": [None, None], "d(u)": [None, None]})))
    assert solution.objective == pytest.approx(12)


def test_no_controls(method: dict[str, Any]) -> None:
    """An oscillator whose stiffness is chosen so that it arrives at its lowest point."""
    system = {**EXPLICIT, "controls": [], "accelerations": {"q": "-k*q"}}
    phase = move(system=system, initial={"q": 1, "d(q)": 0}, final={}, integrals={})
    document = problem(phase, method=method, objective={"minimize": "(final.q + 1)^2"})
    document["static"] = {"k": {"bounds": [1, 20], "guess": 8}}
    if method["kind"] == "chebyshev_lobatto":
        with pytest.raises(BadProblem, match="control"):
            solved(document)
        return
    solution = solved(document)
    assert solution.static["k"] == pytest.approx(3.14159265**2, rel=5e-2)


@pytest.mark.parametrize(
    "expression", ["sqrt(ddd(q) - 1e6)", "log(dd(u) - 9)", "sqrt(-1 - dd(q)^2)"]
)
def test_splines_without_a_value_are_refused_at_their_place(expression: str) -> None:
    path = [{"name": "none", "expression": expression, "lower": 0}]
    with pytest.raises(InvalidModel) as caught:
        solved(problem(move(path=path), method={"kind": "dircol5i"}))
    assert caught.value.issues[0].pointer == "/phases/0/path/0/expression"
