"""Several phases: their names, their times, what links them, statics, guesses."""

from typing import Any

import pytest

from schemas.errors import Issue
from schemas.reading import read_problem
from tests.support.problems import changed, hop, issues

CURVES = {"states": {"breaks": [0, 1, 2], "coefficients": {"x": [[1], [2, 3]]}}}


def hopping(path: str, value: Any) -> dict[str, Any]:
    problem = hop()
    del problem["stages"]
    return changed(path, value, problem)


def only(path: str, value: Any) -> Issue:
    (issue,) = issues(hopping(path, value))
    return issue


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message"),
    [
        ("phases 1 time initial", 0, "/phases/1/time/initial", "starts when 'stance' ends"),
        ("phases 1 time duration", -1, "/phases/1/time/duration", "cannot last: its duration"),
        ("phases 2 time final", 0.2, "/phases/2/time/final", "starts at 0.2 at the earliest"),
        ("phases 2 time duration", [9, 9], "/phases/2/time", "'final' and 'duration' do not fit"),
        ("phases 1 time final", [0, 0.15], "/phases/1/time", "'final' and 'duration' do not fit"),
        ("phases 0 time initial", [None, 0], "/phases/0/time/initial", "without a limit"),
        ("phases 2 time duration", ["m", 1], "/phases/2/time/duration/0", "not a constant"),
    ],
)
def test_times_in_a_row(path: str, value: Any, pointer: str, message: str) -> None:
    issue = only(path, value)
    assert issue.pointer == pointer
    assert message in issue.message
    assert issue.hint


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("phases 2 time", {"duration": [None, 1]}),
        ("phases 2 time", {"final": [None, 0.25], "duration": [0.01, 9]}),
        ("phases 1 time final", [0.2, 0.2]),
        ("phases 0 time", {"final": 1}),
        ("phases 0 time", {"initial": [-2, -1], "final": "m"}),
    ],
)
def test_times_that_fit(path: str, value: Any) -> None:
    assert len(read_problem(hopping(path, value)).phases) == 3


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message"),
    [
        ("linkages 1 name", "rise", "/linkages/1/name", "already the name of a linkage"),
        ("static", {"t": {"bounds": 1}, "k": {"bounds": 1}}, "/static/t", "reserved"),
        ("static k bounds", [2, 1], "/static/k/bounds", "the lower limit 2"),
        ("static k bounds", ["m", 1], "/static/k/bounds/0", "'m' is not a constant"),
        ("static k bounds", [0, 1], "/static/k/guess", "outside of the bounds [0, 1]"),
        ("static k guess", "log(0)", "/static/k/guess", "not a real number"),
        ("linkages 0 lower", "m", "/linkages/0/lower", "'m' is not a constant"),
        ("linkages 0 upper", -1, "/linkages/0", "the lower limit 0 is above"),
        ("phases 0 bounds y", ["k", 1], "/phases/0/bounds/y/0", "'k' is not a constant"),
    ],
)
def test_names_and_limits(path: str, value: Any, pointer: str, message: str) -> None:
    issue = only(path, value)
    assert issue.pointer == pointer
    assert message in issue.message


def test_phases_have_names_of_their_own() -> None:
    problem = hopping("phases 2 name", "stance") | {"objective": None, "linkages": []}
    assert [issue.message for issue in issues(problem)] == [
        "'stance' is already the name of a phase"
    ]
    problem["phases"][2]["name"] = "final"
    assert "reserved" in issues(problem)[0].message


@pytest.mark.parametrize(
    ("field", "name", "kind"),
    [("coordinates", ["x", "k"], "coordinates/1"), ("controls", ["k"], "controls/0")],
)
def test_a_static_is_the_only_one_of_its_name(field: str, name: list[str], kind: str) -> None:
    found = issues(hopping(f"phases 0 system {field}", name))
    assert found[0].pointer == f"/phases/0/system/{kind}"
    assert "already the name of a static parameter" in found[0].message


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("final.y", "mean 'stance.final.y'?"),
        ("stance.final.z", "mean 'stance.final."),
        ("stance.final.d(m)", "mean 'stance."),
        ("stance.d(y)", "write stance.initial.d(y) or stance.final.d(y)"),
        ("stance.k", "write k, without"),
        ("flight.final.d(h)", "has no derivatives"),
        ("hop.final.y", "mean '"),
    ],
)
def test_linkages_and_objective_name_the_phase(text: str, hint: str) -> None:
    for path in ("linkages 0 expression", "objective minimize"):
        issue = only(path, text)
        assert issue.pointer == "/" + path.replace(" ", "/")
        assert f"unknown name '{text}'" in issue.message
        assert hint in issue.hint


def test_everything_is_known_at_the_ends() -> None:
    text = "stance.final.dddd(tip) + flight.initial.since*k + landing.f + stance.m + stance.effort"
    problem = hopping("linkages 0 expression", text.replace("landing.f", "landing.initial.dd(f)"))
    assert read_problem(problem).linkages[0].expression.text.startswith("stance.final.dddd(tip)")


def test_one_phase_may_have_linkages() -> None:
    linkage = {"name": "around", "expression": "final.v1 - swing_up.initial.v1", "upper": 0}
    assert read_problem(changed("linkages", [linkage])).linkages


@pytest.mark.parametrize(
    ("guess", "pointer", "message"),
    [
        ({"kind": "constant", "values": {"z": 1}}, "guess/values/z", "'z' is not a state"),
        ({"kind": "constant", "values": {"d(z)": 1}}, "guess/values/d(z)", "not a state"),
        ({"kind": "constant", "values": {"h": "m"}}, "guess/values/h", "'m' is not a constant"),
        ({"kind": "solution", "phases": [{"name": "s", "curves": {}}]}, "guess/phases", "no phase"),
        (
            {"kind": "solution", "phases": [{"name": "stance", "curves": CURVES}] * 2},
            "guess/phases/1/name",
            "already the name of a phase",
        ),
    ],
)
def test_guesses_of_the_problem(guess: Any, pointer: str, message: str) -> None:
    issue = only("guess", guess)
    assert issue.pointer == f"/{pointer}"
    assert message in issue.message


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message"),
    [
        ("breaks", [0, 1, 1], "breaks/2", "breaks increase"),
        ("breaks", [0], "breaks", "two breaks"),
        ("coefficients", {"x": [[1]]}, "coefficients/x", "1 rows of coefficients for 2 segments"),
        ("coefficients", {"x": [[1], [None]]}, "coefficients/x/1", "is missing (null)"),
        ("coefficients", {"x": [[], [1]]}, "coefficients/x/0", "no coefficients"),
    ],
)
def test_curves_of_a_guess(path: str, value: Any, pointer: str, message: str) -> None:
    curves = {"states": CURVES["states"] | {path: value}}
    guess = {"kind": "solution", "phases": [{"name": "any", "curves": curves}]}
    issue = issues(hopping("phases 0 guess", guess))[0]
    assert issue.pointer == f"/phases/0/guess/phases/0/curves/states/{pointer}"
    assert message in issue.message


def test_the_curves_of_a_guess_span_the_same_time() -> None:
    controls = {"breaks": [0, 3], "coefficients": {}}
    curves = {"states": CURVES["states"], "controls": controls}
    guess = {"kind": "solution", "phases": [{"name": "any", "curves": curves}]}
    issue = issues(hopping("phases 0 guess", guess))[0]
    assert issue.pointer == "/phases/0/guess/phases/0/curves/controls/breaks"
    assert "from 0 to 3 s" in issue.message


def test_guesses_that_fit() -> None:
    curves = {"kind": "solution", "phases": [{"name": "flight", "curves": CURVES}]}
    assert read_problem(hopping("guess", curves)).guess.kind == "solution"
    known_by_some = {"kind": "constant", "values": {"d(x)": "m", "v": "g", "dddd(f)": 0}}
    assert read_problem(hopping("guess", known_by_some)).guess.kind == "constant"
    own = only("phases 2 guess", {"kind": "constant", "values": {"x": 1}})
    assert own.pointer == "/phases/2/guess/values/x"
