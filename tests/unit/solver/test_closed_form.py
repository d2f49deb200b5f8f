"""Motions in closed form: first, last, alone, with and without freedom; against paper."""

from typing import Any

import pytest

from schemas.errors import InvalidModel
from schemas.results import Solution, SolutionStatus
from tests.support.methods import label, variants
from tests.unit.solver.motions import COAST, joined, move, problem
from tests.unit.solver.problems import solved


def coast(**changes: Any) -> dict[str, Any]:
    """A flight at constant speed for one second."""
    flight = {"name": "coast", "system": COAST, "time": {"duration": 1}, "integrals": {}}
    return flight | changes


def pushed(flight: dict[str, Any], **changes: Any) -> Solution:
    links = joined("push", "coast", "q", "v")
    links[1]["expression"] = "push.final.d(q) - coast.initial.v"
    return solved(problem(move("push", final={}), flight, linkages=links, **changes))


@pytest.mark.parametrize("method", variants(second_order=True), ids=label)
def test_a_push_and_a_flight_to_a_target(method: dict[str, Any]) -> None:
    """One second of push, one of flight, one metre: the weight of u is 2 - t."""
    segments = 1 if method["kind"] == "chebyshev_lobatto" else 20
    solution = pushed(coast(final={"q": 1}), method={**method, "segments": segments})
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(3 / 7, rel=1e-3)


def test_a_free_time_of_flight() -> None:
    """Longer is better: up to the limit of two seconds."""
    solution = pushed(coast(time={"duration": [0.1, 2]}, final={"q": 1}))
    assert solution.objective == pytest.approx(3 / (3**3 - 2**3), rel=1e-6)
    assert solution.phases[1].knots[-1] == pytest.approx(3, rel=1e-6)


def test_a_path_constraint_in_flight() -> None:
    """Below half a metre after one second of flight, where one metre would be best."""
    fence = {"name": "fence", "expression": "q + 0*v", "upper": 0.5}
    solution = pushed(coast(final={"v": 1}, path=[fence]))
    assert solution.status is SolutionStatus.CONVERGED
    ends = solution.phases[1].groups["states"].values["q"]
    assert max(value or 0.0 for value in ends) <= 0.5 + 1e-6


def test_a_flight_first() -> None:
    """It arrives with a speed of one metre a second; the brake has one second for it."""
    flight = coast(initial={"q": 0, "v": 1})
    brake = move("brake", initial={}, final={"d(q)": 0}, time={"duration": 1})
    links = joined("coast", "brake", "q")
    links += [{**links[0], "name": "speed", "expression": "coast.final.v - brake.initial.d(q)"}]
    solution = solved(problem(flight, brake, linkages=links))
    assert solution.objective == pytest.approx(1, rel=1e-6)


def test_a_flight_alone_without_any_freedom() -> None:
    flight = coast(initial={"q": 1, "v": 2})
    solution = solved(problem(flight, objective={"minimize": "final.q"}))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(3)


def test_an_integral_along_a_flight() -> None:
    flight = coast(initial={"q": 0}, final={"q": 1}, integrals={"area": "q^2"})
    solution = solved(problem(flight, objective={"minimize": "area"}))
    assert solution.objective == pytest.approx(1 / 3)


def test_a_flight_without_a_value_is_refused_at_its_place() -> None:
    path = [{"name": "high", "expression": "log(q - 3)", "lower": 0}]
    flight = coast(initial={"q": 1, "v": 0}, path=path)
    with pytest.raises(InvalidModel) as caught:
        solved(problem(flight, objective={"minimize": "final.q"}))
    assert caught.value.issues[0].pointer == "/phases/0/path/0/expression"
