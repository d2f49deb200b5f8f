"""What a well-formed problem may still get wrong."""

from typing import Any

import pytest

from schemas.checks.names import RESERVED
from schemas.errors import Issue
from schemas.reading import read_problem
from schemas.values import Bound
from tests.support.problems import PHASE, SYSTEM, cart_pole, changed, issues


def only(path: str, value: Any) -> Issue:
    (issue,) = issues(changed(path, value))
    return issue


@pytest.mark.parametrize("name", sorted(RESERVED))
def test_reserved_names(name: str) -> None:
    found = issues(changed(f"{SYSTEM} controls 0", name))
    assert found[0].pointer == "/phases/0/system/controls/0"
    assert "reserved" in found[0].message


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message"),
    [
        (f"{SYSTEM} controls", ["u", "q1"], "/phases/0/system/controls/1", "a state"),
        (f"{SYSTEM} parameters u", 1, "/phases/0/system/parameters/u", "a control"),
        (f"{SYSTEM} define q1", 1, "/phases/0/system/define/q1", "a state"),
        (f"{PHASE} integrals m1", 1, "/phases/0/integrals/m1", "a parameter"),
        (f"{PHASE} boundary 0 name", "height", "/phases/0/boundary/0/name", "a path constraint"),
    ],
)
def test_a_name_is_taken_once(path: str, value: Any, pointer: str, message: str) -> None:
    issue = only(path, value)
    assert issue.pointer == pointer
    assert f"already the name of {message}" in issue.message


@pytest.mark.parametrize(
    ("path", "value", "pointer", "column", "hint"),
    [
        (f"{SYSTEM} derivatives v1", "u + q3*l", "system/derivatives/v1", 5, "known here: den"),
        (f"{SYSTEM} derivatives v1", "u/denn", "system/derivatives/v1", 3, "mean 'den'?"),
        (f"{SYSTEM} derivatives v1", "-u^2 + effort", "system/derivatives/v1", 8, "at the end"),
        (f"{SYSTEM} derivatives v1", "final.q1", "system/derivatives/v1", 1, "the ends"),
        (f"{SYSTEM} derivatives v1", "q1.__class__", "system/derivatives/v1", 1, ""),
        (f"{SYSTEM} derivatives v1", "u + inf", "system/derivatives/v1", 5, "infinities"),
        (f"{SYSTEM} derivatives v1", "u*time", "system/derivatives/v1", 3, "the time is t"),
        (f"{PHASE} boundary 0 expression", "tf", "boundary/0/expression", 1, "final.t, the time"),
        (f"{SYSTEM} define s", "sin(q2)/den", "system/define/s", 9, "further down"),
        (f"{SYSTEM} define den", "den + 1", "system/define/den", 1, "further down"),
        (f"{PHASE} path 0 expression", "duration", "path/0/expression", 1, "the ends"),
        (f"{PHASE} integrals effort", "effort", "integrals/effort", 1, "an integral"),
        (f"{PHASE} boundary 0 expression", "q1", "boundary/0/expression", 1, "initial.q1 or"),
        (f"{PHASE} boundary 0 expression", "2*t", "boundary/0/expression", 3, "final.t"),
        (f"{PHASE} boundary 0 expression", "den", "boundary/0/expression", 1, "initial.den or"),
        (f"{PHASE} boundary 0 expression", "d(q1)", "boundary/0/expression", 1, "initial.d(q1)"),
        (f"{PHASE} path 0 expression", "d(m1)", "path/0/expression", 1, "has no derivatives"),
        (f"{PHASE} path 0 expression", "d(t)", "path/0/expression", 1, "has no derivatives"),
        (f"{PHASE} path 0 expression", "2*d(qq1)", "path/0/expression", 3, "mean 'd(q1)'?"),
        (f"{PHASE} path 0 expression", "d*q1", "path/0/expression", 1, "write d(x)"),
        (f"{PHASE} boundary 0 expression", "final.q3", "boundary/0/expression", 1, "final.q"),
    ],
)
def test_unknown_names(path: str, value: str, pointer: str, column: int, hint: str) -> None:
    issue = only(path, value)
    assert issue.pointer == f"/phases/0/{pointer}"
    assert issue.column == column
    assert "unknown name" in issue.message
    assert hint in issue.hint


@pytest.mark.parametrize(
    "text",
    ["final.den", "initial.d(den) + swing_up.final.dddd(q1)",
     "effort", "swing_up.effort", "duration", "swing_up.duration", "final.t - initial.t", "m1*2",
     "swing_up.final.q1^2", "initial.u"],
)  # fmt: skip
def test_the_objective_sees_the_ends_with_and_without_the_phase(text: str) -> None:
    assert read_problem(changed("objective minimize", text)).objective is not None


def test_the_objective_does_not_see_the_path() -> None:
    assert only("objective minimize", "effort + u").hint.startswith("write initial.u or final.u")
    assert "'integrals'" in only("objective minimize", "effort + u").hint
    assert only("objective minimize", "t").hint.endswith("or duration for the time taken")
    assert only("objective minimize", "swing_down.effort").hint == "did you mean 'swing_up.effort'?"


def test_derivatives_fit_the_states() -> None:
    problem = cart_pole()
    derivatives = problem["phases"][0]["system"]["derivatives"]
    derivatives["w1"] = derivatives.pop("v1")
    missing, extra = issues(problem)
    assert missing.pointer == "/phases/0/system/derivatives/v1"
    assert extra.pointer == "/phases/0/system/derivatives/w1"
    assert extra.hint == "the states without a derivative are v1"


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message"),
    [
        (f"{PHASE} bounds q3", 1, "bounds/q3", "not a state or a control"),
        (f"{PHASE} bounds t", 1, "bounds/t", "not a state or a control"),
        (f"{PHASE} final den", 1, "final/den", "not a state or a control"),
        (f"{PHASE} bounds d(den)", 1, "bounds/d(den)", "not a state or a control"),
        (f"{PHASE} bounds d(q1)", [2, 1], "bounds/d(q1)", "the lower limit 2 is above the upper"),
        (f"{PHASE} bounds q1", [2, 1], "bounds/q1", "the lower limit 2 is above the upper"),
        (f"{PHASE} bounds q1", ["m1", "g - m3"], "bounds/q1/1", "'m3' is not a constant"),
        (f"{PHASE} bounds q1", ["q2", 9], "bounds/q1/0", "'q2' is not a constant"),
        (f"{PHASE} bounds q1", [0, "1/(m1 - 1)"], "bounds/q1/1", "division by zero"),
        (f"{PHASE} initial q1", 3, "initial/q1", "3 lies outside of the bounds [-2, 2]"),
        (f"{PHASE} final q1", [None, -3], "final/q1", "[null, -3] lies outside"),
        (f"{PHASE} path 0 lower", 3, "path/0", "the lower limit 3 is above the upper limit 2"),
        (f"{PHASE} path 0 lower", "log(m1 - 1)", "path/0/lower", "log(0) is not a real number"),
        (f"{PHASE} time final", 0, "time/final", "the phase cannot last"),
        (f"{PHASE} time final", [-2, -1], "time/final", "the phase cannot last"),
        (f"{PHASE} time initial", [None, 1], "time/initial", "without a limit"),
        (f"{PHASE} time final", [2, 1], "time/final", "the lower limit 2"),
        (f"{PHASE} time final", "tend", "time/final", "'tend' is not a constant"),
    ],
)
def test_values(path: str, value: Any, pointer: str, message: str) -> None:
    issue = only(path, value)
    assert issue.pointer == f"/phases/0/{pointer}"
    assert message in issue.message


@pytest.mark.parametrize(
    ("initial", "final"), [(0, [None, None]), ([0, 10], [0.1, 10]), (["-m1", 0], 2), (-1, 0)]
)
def test_times_that_can_last(initial: Any, final: Any) -> None:
    problem = changed(f"{PHASE} time", {"initial": initial, "final": final})
    assert read_problem(problem).phases[0].time.final == Bound.read(final)


def test_a_broken_parameter_is_blamed_once() -> None:
    issue = only(f"{SYSTEM} parameters m1", "m2/2")
    assert issue.pointer == "/phases/0/system/parameters/m1"
    assert "parameters before it" in issue.hint


def test_guesses() -> None:
    assert only("guess time", [0, 2, 1]).pointer == "/guess/time/2"
    assert only("guess time", [0, 1, 1e101]).pointer == "/guess/time/2"
    assert only("guess values q1", [0, 1]).message == "2 values for 3 times"
    assert only("guess values q9", [0, 1, 2]).pointer == "/guess/values/q9"
    assert only("guess values q1", [0, "k", 2]).pointer == "/guess/values/q1/1"
    assert only("guess", {"kind": "constant", "values": {"z": 1}}).pointer == "/guess/values/z"
