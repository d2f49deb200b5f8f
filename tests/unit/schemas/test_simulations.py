"""Simulations that break the language: the place, the reason and the mend."""

import json
from typing import Any

import pytest

from schemas.errors import BadProblem, Issue
from schemas.reading import read_problem, spec_sha256
from schemas.remarks import simulated_remarks
from schemas.simulations import Simulation, read_simulation

BASE: dict[str, Any] = {
    "system": {
        "kind": "ode",
        "parameters": {"k": 2},
        "states": ["x", "v"],
        "controls": ["u"],
        "derivatives": {"x": "v", "v": "-k*x + u"},
    },
    "initial": {"x": 1},
    "duration": 1,
}


PENDULUM: dict[str, Any] = {
    "kind": "mechanism",
    "bodies": {"rod": {"mass": 1, "inertia": 0.01, "com": [0, -0.5]}},
    "joints": {"pivot": {"kind": "revolute", "child": "rod"}},
}


def issues(**changes: Any) -> list[Issue]:
    with pytest.raises(BadProblem) as caught:
        read_simulation({**BASE, **changes})
    return caught.value.issues


def test_a_simulation_is_read_and_written_back() -> None:
    simulation = read_simulation(json.dumps({**BASE, "duration": "k/2"}))
    assert simulation.method.kind == "smooth"
    again = Simulation.model_validate(simulation.model_dump(mode="json"))
    assert again == simulation
    assert spec_sha256(again) == spec_sha256(simulation)


@pytest.mark.parametrize(
    ("changes", "pointer", "message", "hint"),
    [
        ({"initial": {"y": 1}}, "/initial/y", "'y' is not a state", "the states are x, v"),
        ({"initial": {"u": 1}}, "/initial/u", "'u' is not a state", "the states are x, v"),
        ({"duration": -1}, "/duration", "cannot last", "more than 0"),
        ({"duration": "kk"}, "/duration", "not a constant", "did you mean 'k'?"),
        ({"start": "t"}, "/start", "not a constant", "k"),
        ({"static": {"a": "b"}}, "/static/a", "not a constant", ""),
        ({"dur": 1}, "/dur", "unknown field 'dur'", "duration"),
        ({"method": {"kind": "smoth"}}, "/method/kind", "'smoth'", "did you mean 'smooth'?"),
        ({"method": {"kind": "smooth", "tol": 1}}, "/method/tol", "unknown field", "tolerance"),
        (
            {"method": {"kind": "time_stepping"}},
            "/method/kind",
            "it takes mechanisms",
            "write 'smooth'",
        ),
        (
            {"events": [{"name": "hit", "expression": "x"}]},
            "/events",
            "knows no events",
            '"kind": "events"',
        ),
        (
            {"system": {"kind": "closed_form", "states": {"x": "initial.x"}}, "initial": {}},
            "/system/kind",
            "nothing to simulate",
            "second_order",
        ),
        (
            {"controls": {"kind": "expressions", "values": {"w": "1"}}},
            "/controls/values/w",
            "'w' is not a control",
            "the controls are u",
        ),
        (
            {"controls": {"kind": "expressions", "values": {"u": "2*d(u)"}}},
            "/controls/values/u",
            "cannot depend on the control",
            "controls may use",
        ),
        (
            {"controls": {"kind": "samples", "time": [0, 1], "values": {"u": [1.0]}}},
            "/controls/values/u",
            "1 values for 2 times",
            "",
        ),
        (
            {"controls": {"kind": "samples", "time": [0, 1, 1], "values": {}}},
            "/controls/time/2",
            "times increase",
            "",
        ),
        (
            {"controls": {"kind": "solution", "phases": [{"name": "p", "curves": {}}]}},
            "/controls/phases/0/curves",
            "no curve of the control 'u'",
            "this system",
        ),
        ({"feedback": {}}, "/feedback", "give either 'gains' or 'schedule'", ""),
        (
            {"feedback": {"gains": {"u": {"z": 1}}}},
            "/feedback/gains/u/z",
            "'z' is not a state",
            "the states are x, v",
        ),
        (
            {"feedback": {"schedule": {"time": [0, 1], "gains": {"u": {"x": [1.0]}}}}},
            "/feedback/schedule/gains/u/x",
            "1 values for 2 times",
            "",
        ),
        (
            {"system": {**BASE["system"], "derivatives": {"x": "v"}}},
            "/system/derivatives/v",
            "derivative of the state 'v' is missing",
            "",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_place(
    changes: dict[str, Any], pointer: str, message: str, hint: str
) -> None:
    found = issues(**changes)
    assert found[0].pointer == pointer
    assert message in found[0].message
    assert hint in found[0].hint


def test_expressions_are_shown_by_column() -> None:
    method = {"kind": "events"}
    guards = [
        {"name": "hit", "expression": "x + q", "reset": {"v": "-0.8*w"}},
        {"name": "hit", "expression": "1"},
        {"name": "t", "expression": "x", "reset": {"y": "0"}},
    ]
    found = issues(method=method, events=guards[:2])
    assert [(one.pointer, one.column) for one in found] == [
        ("/events/1/name", None),
        ("/events/0/expression", 5),
        ("/events/0/reset/v", 6),
    ]
    assert "an event" in found[0].message
    assert issues(method=method, events=guards[2:])[0].pointer == "/events/0/reset/y"
    control = {"kind": "expressions", "values": {"u": "-k*xx"}}
    assert issues(controls=control)[0] == Issue(
        "/controls/values/u", "unknown name 'xx'", "did you mean 'x'?", 4
    )
    gains = {"gains": {"u": {"x": "1 + tt"}}, "reference": None}
    assert issues(feedback=gains)[0].pointer == "/feedback/gains/u/x"
    reference = {"kind": "expressions", "values": {"x": "sin(s)"}}
    found = issues(feedback={"gains": {"u": {"x": 1}}, "reference": reference})
    assert (found[0].pointer, found[0].column) == ("/feedback/reference/values/x", 5)


def test_a_mode_is_of_smooth_simulations() -> None:
    system = {
        "kind": "mechanism",
        "bodies": {"ball": {"mass": 1, "inertia": 1}},
        "joints": {"free": {"kind": "floating", "child": "ball"}},
        "contacts": {"foot": {"body": "ball"}},
        "mode": {"foot": "sticking"},
    }
    document = {"system": system, "duration": 1, "method": {"kind": "events"}}
    with pytest.raises(BadProblem) as caught:
        read_simulation(document)
    assert caught.value.issues[0].pointer == "/system/mode"


def test_what_is_no_json_object_is_refused() -> None:
    for data in ("[]", "{", '{"duration": NaN}'):
        with pytest.raises(BadProblem):
            read_simulation(data)


def test_a_document_of_the_other_kind_is_sent_to_its_place() -> None:
    problem = {"phases": [{"system": BASE["system"], "time": {"final": 1}}]}
    with pytest.raises(BadProblem) as caught:
        read_simulation(problem)
    (issue,) = caught.value.issues
    assert issue.message == "this is a problem, not a simulation"
    assert "POST /v1/jobs" in issue.hint
    assert "footfall solve" in issue.hint
    with pytest.raises(BadProblem) as caught:
        read_problem(BASE)
    (issue,) = caught.value.issues
    assert issue.message == "this is a simulation, not a problem"
    assert "POST /v1/simulations" in issue.hint
    assert "footfall simulate" in issue.hint


def test_a_problem_without_its_phase_is_no_simulation() -> None:
    with pytest.raises(BadProblem) as caught:
        read_problem({"system": BASE["system"], "time": {"final": 1}})
    assert any(issue.pointer == "/phases" for issue in caught.value.issues)


def test_a_rate_is_written_as_a_derivative() -> None:
    (issue,) = issues(system=PENDULUM, initial={"pivot_dot": 1})
    assert issue.pointer == "/initial/pivot_dot"
    assert issue.hint == "write d(pivot)"


@pytest.mark.parametrize(
    ("change", "place"),
    [({"parent": "grund"}, "parent"), ({"child": "rdo"}, "child"), ({"parent": "rod"}, "parent")],
)
def test_of_a_mechanism_that_does_not_hang_together_the_cause_alone_is_named(
    change: dict[str, Any], place: str
) -> None:
    joints = {"pivot": {**PENDULUM["joints"]["pivot"], **change}}
    (issue,) = issues(system={**PENDULUM, "joints": joints}, initial={"pivot": 1})
    assert issue.pointer == f"/system/joints/pivot/{place}"


def test_what_is_hardly_meant_is_remarked_on() -> None:
    given = {
        "system": PENDULUM,
        "initial": {"pivot": 45},
        "duration": 0.1,
        "method": {"kind": "time_stepping", "step": 0.9},
    }
    degrees, step = simulated_remarks(read_simulation(given))
    assert degrees.startswith("/initial/pivot: an angle of 45 rad")
    assert step.startswith("/method/step: one step of 0.9 s is longer than the duration")
    assert not list(simulated_remarks(read_simulation({**given, "initial": {}, "duration": 2})))


def test_very_many_expressions_are_all_looked_at() -> None:
    names = [f"x{row}" for row in range(150)]
    system = {"kind": "ode", "states": names, "derivatives": dict.fromkeys(names, "1")}
    guards: list[dict[str, Any]] = [
        {"name": f"g{row}", "expression": "x1", "reset": dict.fromkeys(names, "x2")}
        for row in range(3)
    ]
    guards[2]["reset"]["x149"] = "x2 + y"
    method = {"kind": "events"}
    with pytest.raises(BadProblem) as caught:
        read_simulation({"system": system, "duration": 1, "method": method, "events": guards})
    (issue,) = caught.value.issues
    assert (issue.pointer, issue.column) == ("/events/2/reset/x149", 6)
