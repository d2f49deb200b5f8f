"""Periodic phases of any system."""

from typing import Any

import pytest

import examples
from schemas.errors import BadProblem
from schemas.reading import read_problem
from solver import solve
from solver.hybrid import expand
from tests.unit.hybrid.documents import slider

ODE: dict[str, Any] = {
    "kind": "ode",
    "states": ["left", "right", "way"],
    "controls": ["u", "w"],
    "derivatives": {"left": "u", "right": "w", "way": "left"},
}


def document(periodic: dict[str, Any], **changes: Any) -> dict[str, Any]:
    phase = {
        "name": "step",
        "system": ODE,
        "time": {"final": 1.0},
        "initial": {"left": 0, "way": 0},
        "final": {"left": 1},
        "integrals": {"effort": "u^2 + w^2"},
        "periodic": periodic,
    }
    return {
        "phases": [phase | changes],
        "objective": {"minimize": "effort"},
        "method": {"kind": "radau", "segments": 5, "points": 3},
        "refinement": None,
    }


def test_sides_are_exchanged() -> None:
    """The right one goes from where the left one ends to where it began."""
    solution = solve(read_problem(document({"swap": [["left", "right"]], "free": ["way"]})))
    assert solution.status == "converged", solution.message
    values = solution.phases[0].groups["states"].values
    assert (values["right"][0], values["right"][-1]) == pytest.approx((1, 0), abs=1e-8)
    assert solution.objective == pytest.approx(2, rel=1e-7)


def test_all_comes_back_unless_it_is_free() -> None:
    """Way is the integral of a state that has to come back: it returns by going below zero."""
    solution = solve(read_problem(document({}, initial={}, final={}, boundary=[])))
    values = solution.phases[0].groups["states"].values
    for name in ("left", "right", "way"):
        assert values[name][0] == pytest.approx(values[name][-1], abs=1e-8)


def test_controls_that_are_states_come_back_too() -> None:
    """The rate of u is used, so u does not jump at the period's end."""
    periodic = {"swap": [["left", "right"]], "free": ["way"]}
    solution = solve(
        read_problem(document(periodic, integrals={"effort": "u^2 + w^2 + 0.01*d(u)^2"}))
    )
    values = solution.phases[0].groups["controls"].values["u"]
    assert values[0] == pytest.approx(values[-1], abs=1e-7)


def issues(problem: dict[str, Any]) -> list[tuple[str, str]]:
    with pytest.raises(BadProblem) as caught:
        read_problem(problem)
    return [(issue.pointer, issue.message) for issue in caught.value.issues]


STAND = [{"name": "stand", "contacts": {"foot": "sticking"}}]


@pytest.mark.parametrize(
    ("problem", "pointer", "message"),
    [
        (
            document({"swap": [["left", "rihgt"]]}),
            "/phases/0/periodic/swap/0/1",
            "there is nothing called 'rihgt' to exchange",
        ),
        (
            document({"swap": [["left", "right"], ["right", "way"]]}),
            "/phases/0/periodic/swap/1/0",
            "'right' is exchanged twice",
        ),
        (
            document({"swap": [["left", "u"]]}),
            "/phases/0/periodic/swap",
            "the exchange makes 'u' of 'left', which is no state",
        ),
        (document({"free": ["base"]}), "/phases/0/periodic/free/0", "'base' is not a state"),
        (
            document({"impact": {"lands": ["foot"]}}),
            "/phases/0/periodic/impact",
            "impacts are of mechanisms, this system is an ode",
        ),
        (
            slider(STAND, periodic={"impact": {"lands": ["toe"]}}),
            "/phases/0/periodic/impact/lands/0",
            "there is no contact 'toe'",
        ),
        (
            slider(STAND, periodic={"impact": {"lands": ["foot"]}}),
            "/phases/0/periodic/impact/lands",
            "from the last mode to the first one, exchanged, these are: none",
        ),
        (
            slider([STAND[0] | {"contacts": {"feet": "sticking"}}]),
            "/method/sequence/0/contacts/feet",
            "there is no contact 'feet'",
        ),
        (
            slider([STAND[0], STAND[0]]),
            "/method/sequence/1/name",
            "'stand' is already the name of a mode of this sequence",
        ),
        (
            document({}) | {"method": slider(STAND)["method"]},
            "/method/kind",
            "hybrid is for mechanisms, the system of the phase 'step' is an ode",
        ),
    ],
)
def test_wrong_words_are_told(problem: dict[str, Any], pointer: str, message: str) -> None:
    assert (pointer, message) in issues(problem)


@pytest.mark.parametrize("kind", ["chebyshev_lobatto", "multiple_shooting"])
def test_methods_that_would_drift_are_refused(kind: str) -> None:
    problem = slider(STAND)
    problem["phases"][0]["system"]["mode"] = {"foot": "sticking"}
    found = issues(problem | {"method": {"kind": kind}})
    assert any(f"{kind} lets contacts and loops drift" in message for _, message in found)


def test_a_mode_beside_a_sequence_is_refused() -> None:
    problem = slider(STAND)
    problem["phases"][0]["system"]["mode"] = {"foot": "sticking"}
    assert issues(problem)[0][0] == "/phases/0/system/mode"


def test_what_is_exchanged_is_alike() -> None:
    problem = examples.load("five_link_biped")
    problem["phases"][0]["system"]["bodies"]["swing_tibia"]["mass"] = 4
    told = "'stance_tibia' and 'swing_tibia' differ in mass, inertia or centre of mass"
    assert ("/phases/0/periodic/swap/0", told) in issues(problem)


def test_a_mode_takes_part_in_the_impact_of_its_period() -> None:
    """Without a sequence, too: what touches at the start touches after the impact."""
    problem = examples.load("five_link_biped_floating")
    problem["phases"][0]["system"]["mode"] = {"left_foot": "sticking"}
    problem["method"] = {"kind": "hermite_simpson", "segments": 25}
    expanded = expand(read_problem(problem)).problem
    assert set(expanded.static) == {
        f"step.impact.right_foot.{way}" for way in ("normal", "tangential")
    }
