"""Several phases: linkages, times, methods of their own; against optima known on paper."""

import itertools
from typing import Any

import pytest

import examples
from schemas.errors import InvalidModel
from schemas.reading import read_problem
from schemas.results import SolutionStatus
from solver.prepare import prepare
from tests.unit.solver.motions import EXPLICIT, IMPLICIT, REST, equal, joined, move, problem
from tests.unit.solver.problems import solved

METHODS: list[dict[str, Any]] = [
    {"kind": "hermite_simpson", "segments": 30},
    {"kind": "radau", "segments": 3},
    {"kind": "multiple_shooting", "segments": 20},
    {"kind": "chebyshev_lobatto", "degree": 14},
]
STATE = ("q", "d(q)")


@pytest.mark.parametrize(("one", "two"), list(itertools.permutations(METHODS, 2)), ids=str)
def test_each_phase_by_its_own_method(one: dict[str, Any], two: dict[str, Any]) -> None:
    document = examples.load("interior_point")
    for phase, method in zip(document["phases"], (one, two), strict=True):
        phase["method"] = method
    solution = solved(document | {"refinement": None})
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(0.9205314415, rel=1e-6)


@pytest.mark.parametrize("method", [{"kind": "dircol5i"}, *METHODS], ids=str)
@pytest.mark.parametrize("joint", [0.5, [0.2, 0.8]])
def test_a_joint_changes_nothing(method: dict[str, Any], joint: Any) -> None:
    """Half of the way is made at half of the time."""
    first = move("a", time={"final": joint}, final={"q": 0.5})
    second = move("b", system=IMPLICIT, initial={}, method=method)
    solution = solved(problem(first, second, linkages=joined("a", "b", *STATE)))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(12, rel=1e-6)


@pytest.mark.parametrize(
    ("time", "duration"),
    [({"final": 3}, 2), ({"duration": 2}, 2), ({"final": [1.5, 2.5]}, 1.5)],
)
def test_a_later_phase_in_its_time(time: dict[str, Any], duration: float) -> None:
    """The second push of one metre takes as long as it may."""
    solution = solved(problem(move("a"), move("b", time=time, initial=REST)))
    assert solution.status is SolutionStatus.CONVERGED
    knots = solution.phases[1].knots
    assert knots[0] == 1
    assert knots[-1] - knots[0] == pytest.approx(duration, rel=1e-6)
    assert solution.objective == pytest.approx(12 + 12 / duration**3, rel=1e-6)


def test_ends_and_durations_limit_each_other() -> None:
    time = {"initial": 0, "final": [0.5, 2], "duration": [1, 5]}
    slow = solved(problem(move(time=time)))
    assert slow.objective == pytest.approx(12 / 2**3, rel=1e-6)
    fast = solved(problem(move(time=time), objective={"minimize": "duration"}))
    assert fast.objective == pytest.approx(1, rel=1e-6)


def test_linkages_over_intermediates_and_their_rates() -> None:
    system = {**EXPLICIT, "define": {"w": "q + d(q)"}}
    first, second = move("a", system=system, final={}), move("b", system=system, initial={})
    links = joined("a", "b", "w", "d(w)", "q")
    second["time"] = {"duration": 1}
    solution = solved(problem(first, second, linkages=links))
    free = solved(problem(first, second, linkages=joined("a", "b", *STATE, "u")))
    assert solution.status is SolutionStatus.CONVERGED
    assert solution.objective == pytest.approx(12 / 2**3, rel=1e-6)
    assert free.objective == pytest.approx(12 / 2**3, rel=1e-6)


def test_linkages_that_others_imply_are_dropped_by_name() -> None:
    second = move("b", initial={}, time={"duration": 1})
    links = [
        *joined("a", "b", *STATE),
        equal("a.final.q + a.final.d(q)", "b.initial.q + b.initial.d(q)"),
    ]
    solution = solved(problem(move("a", final={}), second, linkages=links))
    assert solution.objective == pytest.approx(1.5, rel=1e-6)
    assert "'linkage link' follows from the other equalities and was dropped." in solution.warnings


def row(expression: str, **limits: float) -> dict[str, Any]:
    return {"name": "ends", "expression": expression, **limits}


def test_what_is_violated_is_told_with_its_phase() -> None:
    first = move("a", final={}, boundary=[row("final.q", upper=9)])
    second = move("b", initial={}, time={"duration": 1}, boundary=[row("final.q^2", upper=-1)])
    solution = solved(problem(first, second))
    assert solution.status is SolutionStatus.LOCALLY_INFEASIBLE
    worst = solution.solver.residuals[0]
    assert (worst.name, worst.phase, worst.time) == ("boundary ends", "b", None)


def test_what_has_no_value_is_refused_at_its_place() -> None:
    first = move("a", final={}, boundary=[row("final.q", upper=9)])
    second = move("b", initial={}, boundary=[row("log(final.q - 1)", lower=-9)])
    second["time"] = {"duration": 1}
    assert refused(problem(first, second)) == "/phases/1/boundary/0/expression"
    second["boundary"] = []
    link = equal("a.final.q", "log(b.final.q - 1)")
    assert refused(problem(first, second, linkages=[link])) == "/linkages/0/expression"


def refused(document: dict[str, Any]) -> str:
    with pytest.raises(InvalidModel) as caught:
        solved(document)
    return caught.value.issues[0].pointer


def test_guesses_end_in_time_for_the_phases_after_them() -> None:
    times: list[dict[str, Any]] = [{"final": [0, 10]}, {"duration": [0.1, 2]}, {"final": 0.5}]
    phases = [
        move(name, time=time, initial={}, final={}) for name, time in zip("abc", times, strict=True)
    ]
    _, setting = prepare(read_problem(problem(*phases)))
    spans = [(guess.start, guess.end) for guess in setting.guesses]
    assert spans[0][0] == 0
    assert spans[-1][1] == 0.5
    assert all(start < end for start, end in spans)
    assert [end for _, end in spans[:-1]] == [start for start, _ in spans[1:]]


def test_an_integral_with_poles_of_both_signs_is_no_crash() -> None:
    """At its guess, where u is zero at one node and the pole's other side at the next."""
    guess = {"kind": "points", "time": [0, 0.495, 0.5, 1], "values": {"u": [1, 1, 0, 0]}}
    phase = move(integrals={"effort": "1/u - 1/(1 - u)"}, guess=guess)
    with pytest.raises(InvalidModel) as caught:
        solved(problem(phase))
    assert caught.value.issues[0].pointer == "/phases/0/integrals/effort"
