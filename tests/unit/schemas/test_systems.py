"""Second-order systems, closed forms, and derivatives in time: what each may say."""

import copy
from typing import Any

import pytest

from schemas.errors import Issue
from schemas.reading import read_problem
from tests.support.problems import SYSTEM, cart_pole, changed, hop, issues

STANCE, FLIGHT, LANDING = "phases 0 system", "phases 1 system", "phases 2 system"
SHOOTING = {"kind": "multiple_shooting"}


def only(*changes: tuple[str, Any]) -> Issue:
    (issue,) = issues(hopping(*changes))
    return issue


def hopping(*changes: tuple[str, Any]) -> dict[str, Any]:
    problem = hop()
    del problem["stages"]
    for path, value in changes:
        problem = changed(path, value, problem)
    return problem


def test_all_kinds_answer_alike() -> None:
    stance, flight, landing = (phase.system for phase in read_problem(hop()).phases)
    assert stance.state_names == ["x", "y", "d(x)", "d(y)"]
    assert (flight.state_names, flight.control_names) == (["h", "v"], [])
    assert [label for _, label, _ in stance.equations()] == [
        "acceleration of x",
        "acceleration of y",
    ]
    assert [parts for parts, _, _ in landing.equations()] == [("residual", 0)]


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message", "hint"),
    [
        (f"{STANCE} accelerations", {"x": 1}, "accelerations/y", "acceleration of the", '"y": "'),
        (f"{STANCE} accelerations z", 1, "accelerations/z", "'z' is not a coordinate", "take it"),
        (f"{STANCE} accelerations x", "y1", "accelerations/x", "unknown name 'y1'", "'y'"),
        (f"{LANDING} residual", ["dd(y)", 1], "residual", "2 residuals for 1 coordinates", "one"),
        (f"{LANDING} residual", [], "residual", "0 residuals for 1 coordinates", "one"),
        (f"{FLIGHT} states h", "initial.h + t", "states/h", "does not give initial.h", "0 at t ="),
        (f"{FLIGHT} states h", "initial.v", "states/h", "does not give initial.h", "0 at t ="),
        (f"{FLIGHT} states h", "h", "states/h", "unknown name 'h'", "write initial.h"),
        (f"{FLIGHT} define since", "h", "define/since", "unknown name 'h'", "write initial.h"),
        (f"{FLIGHT} states h", "initial.d(h)", "states/h", "unknown name", "has no derivatives"),
        (f"{FLIGHT} states d", "initial.h", "states/d", "does not give initial.d", "0 at t ="),
    ],
)
def test_equations(path: str, value: Any, pointer: str, message: str, hint: str) -> None:
    issue = only((path, value))
    assert issue.pointer == f"/{path[:15].replace(' ', '/')}/{pointer}".replace("//", "/")
    assert message in issue.message
    assert hint in issue.hint


def test_either_accelerations_or_a_residual() -> None:
    assert "either 'accelerations' or" in only((f"{STANCE} residual", ["1", "1"])).message
    assert "either 'accelerations' or" in only((f"{LANDING} residual", None)).message


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("phases 1 path 0 expression", "d(h)"),
        ("phases 1 path 0 expression", "d(since)"),
        ("objective minimize", "flight.final.d(h)"),
        ("phases 1 bounds", {"d(h)": 1}),
        ("phases 1 guess", {"kind": "constant", "values": {"d(h)": 1}}),
    ],
)
def test_a_closed_form_has_no_derivatives(path: str, value: Any) -> None:
    message = str(only((path, value)))
    assert "no derivatives" in message


@pytest.mark.parametrize(
    ("equations", "chain"),
    [
        ({"v1": "d(v2) + u", "v2": "d(v1)"}, "d(v1) needs d(v2), which needs d(v1)"),
        ({"v1": "2*d(v1)"}, "d(v1) needs d(v1)"),
        ({"v1": "dd(v1)"}, "d(v1) needs dd(v1)"),
        ({"q1": "v1 + d(s)", "q2": "d(q1)"}, "d(q1) needs d(s), which needs d(q2), which needs d("),
        ({"q1": "dd(q2)", "q2": "d(q1)"}, "d(q1) needs dd(q2), which needs dd(q1)"),
    ],
)
def test_what_needs_itself_is_refused(equations: dict[str, str], chain: str) -> None:
    problem = cart_pole()
    problem["phases"][0]["system"]["derivatives"] |= equations
    (issue,) = issues(problem)
    assert issue.pointer.startswith("/phases/0/system/derivatives/")
    assert chain in issue.message


def test_derivatives_in_the_dynamics_may_follow_each_other() -> None:
    problem = changed(f"{SYSTEM} derivatives v1", "d(v2) + d(s) + d(u)")
    problem["phases"][0]["system"]["define"]["rate"] = "dd(q1)"
    assert read_problem(problem).phases[0].system.define["rate"].text == "dd(q1)"
    assert read_problem(hopping((f"{STANCE} accelerations x", "dd(y)"))).phases
    circle = only((f"{STANCE} accelerations y", "d(tip) + dd(x) - dd(tip)"))
    assert "dd(y) needs dd(tip), which needs dd(y)" in circle.message
    assert "'residual'" in circle.hint


def test_a_residual_settles_accelerations() -> None:
    assert read_problem(hopping((f"{LANDING} residual", ["dd(y)^2 + sin(dd(y)) - f"]))).phases
    assert only((f"{LANDING} residual", ["ddd(y) - f"])).hint == "use dd(y) at the most"
    problem = hopping((f"{LANDING} define", {"z": "d(y)"}), (f"{LANDING} residual", ["dd(z)"]))
    (issue,) = issues(problem)
    assert "needs ddd(y) (by way of dd(z))" in issue.message


def test_a_long_row_of_intermediates_is_no_trouble() -> None:
    problem = hopping()
    define = problem["phases"][0]["system"]["define"]
    define |= {"z0": "y"} | {f"z{k}": f"z{k - 1} + y" for k in range(1, 3000)}
    assert read_problem(problem).phases
    problem["phases"][0]["system"]["accelerations"]["y"] = "dd(z2999)"
    (issue,) = issues(copy.deepcopy(problem))
    assert "dd(y) needs itself" in issue.message


@pytest.mark.parametrize(
    ("changes", "pointer", "message"),
    [
        ([("method", {"kind": "dircol5i"}), (f"{LANDING} define", {})], "", ""),
        ([("phases 1 method", {"kind": "radau"})], "/phases/1/method", "not transcribed"),
        (
            [("phases 2 integrals", {"e": "ddd(f)"})],
            "/phases/2/integrals/e",
            "ddd(f) is too high: f has 2 derivatives here",
        ),
        (
            [("phases 2 bounds", {"ddd(f)": 1})],
            "/phases/2/bounds/ddd(f)",
            "f has 2 derivatives here",
        ),
        (
            [(f"{LANDING} define", {"z": "d(y)"}), ("phases 2 integrals", {"e": "dddd(z)"})],
            "/phases/2/integrals/e",
            "dddd(z) needs derivative 5 of y",
        ),
        (
            [("objective minimize", "landing.final.dddd(f)")],
            "/objective/minimize",
            "dddd(f) is too high",
        ),
        ([("phases 2 integrals", {"e": "dd(f) + dddd(y)"})], "", ""),
        ([("phases 0 integrals e", "dddd(y) + dddd(tip) + dddd(u)")], "", ""),
        (
            [(f"{STANCE} define tip", "d(u)"), ("phases 0 integrals e", "dddd(tip)")],
            "/phases/0/integrals/e",
            "dddd(tip) needs derivative 5 of u",
        ),
        ([("phases 2 method", SHOOTING)], "", ""),
        (
            [("phases 2 method", SHOOTING), (f"{LANDING} residual", ["f*dd(y)/2 - d(y)^2"])],
            "",
            "",
        ),
        (
            [("phases 2 method", SHOOTING), (f"{LANDING} residual", ["dd(y)^2 - f"])],
            "/phases/2/system/residual/0",
            "linear in the accelerations",
        ),
        (
            [
                ("phases 2 method", SHOOTING),
                (f"{LANDING} define", {"z": "sin(d(y))", "w": "d(z)*y"}),
                (f"{LANDING} residual", ["-w/(1 + y) + d(z)"]),
            ],
            "",
            "",
        ),
        (
            [
                ("phases 2 method", SHOOTING),
                (f"{LANDING} define", {"z": "1/dd(y)"}),
                (f"{LANDING} residual", ["z"]),
            ],
            "/phases/2/system/residual/0",
            "linear in the accelerations",
        ),
    ],
)
def test_methods_fit_their_phases(
    changes: list[tuple[str, Any]], pointer: str, message: str
) -> None:
    if not message:
        assert read_problem(hopping(*changes)).phases
        return
    issue = only(*changes)
    assert issue.pointer == pointer
    assert message in issue.message


def test_first_order_systems_have_no_quintic_splines() -> None:
    (issue,) = issues(changed("method", {"kind": "dircol5i"}))
    assert issue.pointer == "/method/kind"
    assert "'swing_up' is an ode" in issue.message
    assert "hermite_simpson" in issue.hint
