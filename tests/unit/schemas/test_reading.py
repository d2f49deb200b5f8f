"""Reading a problem: every mistake gets its place, its reason and its mend."""

import json
import math
import time
from typing import Any

import pytest

from schemas.expressions import Expression
from schemas.limits import MODEL_LIMITS
from schemas.problem import Problem
from schemas.reading import MAX_ISSUES, canonical, read_problem, spec_sha256
from tests.support.problems import PHASE, SYSTEM, cart_pole, changed, issues


def test_a_problem_is_read_from_all_three_forms() -> None:
    text = json.dumps(cart_pole())
    problem = read_problem(cart_pole())
    assert problem == read_problem(text) == read_problem(text.encode())
    assert problem.phases[0].system.define["s"] == Expression.read("sin(q2)")
    assert problem.model_dump(mode="json")["phases"][0]["bounds"] == {
        "q1": [-2.0, "2*m1"],
        "u": [-20.0, 20.0],
    }


def test_a_problem_may_have_no_objective_and_numbers_for_expressions() -> None:
    problem = changed("phases 0 system derivatives q1", 0)
    del problem["objective"]
    assert read_problem(problem).objective is None


def test_the_canonical_form_reads_back_and_ignores_what_is_known() -> None:
    problem = read_problem(cart_pole())
    again = read_problem(canonical(problem))
    assert again.known == []
    assert again == problem.model_copy(update={"known": []})
    assert spec_sha256(again) == spec_sha256(problem)
    assert len(spec_sha256(problem)) == 64


def test_the_hash_ignores_order_without_meaning_and_nothing_else() -> None:
    problem, turned = cart_pole(), cart_pole()
    phase = turned["phases"][0]
    phase["bounds"] = dict(reversed(phase["bounds"].items()))
    assert spec_sha256(read_problem(turned)) == spec_sha256(read_problem(problem))
    phase["bounds"]["q1"] = [-2, "2.5*m1"]
    assert spec_sha256(read_problem(turned)) != spec_sha256(read_problem(problem))


@pytest.mark.parametrize(
    ("text", "pointer", "message"),
    [
        (b"", "", "empty"),
        (b'{"name": }', "", "line 1, column 10"),
        (b"\xff\xfe", "", "UTF-8"),
        (b"[1, 2]", "", "a JSON object"),
        (b"3", "", "a JSON object"),
        (b'{"a": [1, NaN]}', "/a/1", "NaN"),
        (b'{"a": -Infinity}', "/a", "infinities"),
        (b'{"a": 1e999}', "/a", "infinities"),
        (b'{"a": ' + b"9" * 5000 + b"}", "/a", "infinities"),
        (b'{"b": {"a": 1, "a": 2}}', "/b/a", "more than once"),
        (b'{"a": "\\ud800"}', "/a", "surrogate"),
        (b'{"\\ud800": 1}', "", "a key"),
        (b"[" * 100_000, "", "nesting"),
        (b'{"a":' * 100_000, "", "nesting"),
        (b"[" * 200 + b"]" * 200, "", "nesting"),
    ],
    ids=lambda value: repr(value[:12]),
)
def test_bad_json(text: bytes, pointer: str, message: str) -> None:
    start = time.perf_counter()
    (issue,) = issues(text)
    assert issue.pointer == pointer
    assert message in issue.message
    assert issue.hint or not issue.message.startswith("not JSON")
    assert time.perf_counter() - start < 1.0


def test_data_that_no_json_has() -> None:
    loop: dict[str, Any] = {}
    loop["loop"] = loop
    assert "nesting" in issues(loop)[0].message
    assert "not a type of JSON" in issues({"name": {1, 2}})[0].message
    assert "a key" in issues({1: 2})[0].message
    assert issues({"name": math.nan})[0].pointer == "/name"


@pytest.mark.parametrize(
    ("path", "value", "pointer", "message", "hint"),
    [
        ("method segment", 3, "/method/segment", "unknown field", "did you mean 'segments'?"),
        ("metod", {}, "/metod", "unknown field 'metod'", "did you mean 'method'?"),
        ("[key]", 1, "/[key]", "unknown field '[key]'", ""),
        ("x/y~z", 1, "/x~1y~0z", "unknown field", "the fields here are name"),
        ("method segments", "many", "/method/segments", "a whole number", ""),
        ("method segments", 0, "/method/segments", "a number greater than or equal to 1", ""),
        ("method kind", "hermite", "/method/kind", "'hermite' is none of", "'hermite_simpson'"),
        ("method kind", 7, "/method/kind", "expected one of", ""),
        ("method", {}, "/method/kind", "the field 'kind' is missing", "'trapezoidal'"),
        ("method", [], "/method", "expected an object, {...}, got a list", '{"kind": "'),
        ("method", "trapezoidal", "/method", "got a text", 'write {"kind": "trapezoidal"}'),
        ("guess", [0, 1], "/guess", "got a list", "the kinds are constant, linear, points"),
        ("objective", "effort", "/objective", "got a text", 'write {"minimize": "effort"}'),
        ("objective maximize", "1", "/objective/maximize", "unknown", "minimize the negative"),
        ("integrals", {}, "/integrals", "unknown field", "it belongs into a phase"),
        ("states", [], "/states", "unknown field", "it belongs into a phase's 'system'"),
        (f"{PHASE} objective", {}, "/phases/0/objective", "unknown", "the problem itself"),
        (f"{PHASE} time", [0, 1], "/phases/0/time", "got a list", "initial, final"),
        (f"{PHASE} initial", [0, 0], "/phases/0/initial", "got a list", "each under its name"),
        (
            f"{PHASE} time",
            {"final": None},
            "/phases/0/time",
            "give 'final', 'duration' or both",
            "",
        ),
        (f"{PHASE} time initial", {}, "/phases/0/time/initial", "[lower, upper]", "[0, null]"),
        (f"{SYSTEM} states", "q1", "/phases/0/system/states", "got a text", 'write ["q1"]'),
        (f"{SYSTEM} states", {}, "/phases/0/system/states", "got an object", "in brackets"),
        (f"{SYSTEM} coordinates", [], "/phases/0/system/coordinates", "unknown", "second_order"),
        (
            f"{SYSTEM} derivatives",
            {"d(q1)": 0},
            "/phases/0/system/derivatives/d(q1)",
            "is not a name",
            "alone, q1",
        ),
        ("switches", True, "/switches", "unknown field", "it belongs into 'refinement'"),
        ("refinement", {"switches": 1}, "/refinement/switches", "expected true or false", ""),
        ("method n", 1, "/method/n", "unknown field", "the fields here are kind, segments"),
        ("static", {"k": [1, 2]}, "/static/k", "got a list", 'write {"bounds": [1, 2]}'),
        ("nonsmooth", "slack", "/nonsmooth", "got a text", 'write {"abs": "slack"}'),
        ("nonsmooth", {"tanh": 1}, "/nonsmooth/abs", "is missing", '"abs": {"tanh": 0.01}'),
        ("method form", "seperated", "/method/form", "'seperated' is none of", "'separated'"),
        ("guess kind", "point", "/guess/kind", "none of", "did you mean 'points'?"),
        ("guess time", [0, "x", 2], "/guess/time/1", "expected a number", ""),
        ("refinement", 3, "/refinement", "expected an object", ""),
        ("refinement tolerance", None, "/refinement/tolerance", "expected a number", ""),
        ("phases", [], "/phases", "one entry or more, got none", ""),
        ("phases", {}, "/phases", "expected a list", ""),
        (f"{PHASE} time", {}, "/phases/0/time", "give 'final', 'duration' or both", ""),
        (f"{PHASE} name", "a b", "/phases/0/name", "'a b' is not a name", "a letter"),
        ("name", "two\nlines", "/name", "one line", ""),
        (f"{PHASE} bounds u", [1], "/phases/0/bounds/u", "a pair [lower, upper]", ""),
        (f"{PHASE} bounds u", [1, {}], "/phases/0/bounds/u/1", "expected a number", ""),
        (f"{PHASE} bounds", {"a b": 1}, "/phases/0/bounds/a b", "is not a name", ""),
        (f"{PHASE} path 0 upper", True, "/phases/0/path/0/upper", "expected a number", ""),
        (f"{PHASE} path", [{"name": "a", "expression": 1}], "/phases/0/path/0", "'lower'", ""),
        (f"{PHASE} bounds", {"d(x^2)": 1}, "/phases/0/bounds/d(x^2)", "is not a name", "dddd(x)"),
        (f"{SYSTEM} kind", "odes", "/phases/0/system/kind", "'odes' is none of", "'ode'"),
        (
            f"{SYSTEM}",
            {"kind": "library", "name": "x"},
            "/phases/0/system",
            "'library' is",
            "write it out",
        ),
        ("guess", {"from_job": "x"}, "/guess", "'from_job' is", "write it out"),
        ("guess", {"kind": "from_job", "id": "x"}, "/guess/kind", "no kind", '{"from_job": "'),
        (f"{PHASE} guess", {"from_job": "x"}, "/phases/0/guess", "'from_job' is", "write it out"),
        (f"{PHASE} guess", {"kind": "linea"}, "/phases/0/guess/kind", "none of", "'linear'"),
        (f"{PHASE} method", {"kind": "radau", "x": 1}, "/phases/0/method/x", "unknown field", ""),
        ("nonsmooth", {"abs": "slak"}, "/nonsmooth/abs", "'slak' is no", '"abs": "slack"'),
        ("nonsmooth", {"abs": 3}, "/nonsmooth/abs", "expected an object", "tanh, sqrt"),
        ("nonsmooth", {"abs": {"tan": 1}}, "/nonsmooth/abs/tan", "unknown field", "'tanh'"),
        ("nonsmooth", {"abs": {"tanh": 0}}, "/nonsmooth/abs/tanh", "greater than 0", ""),
        ("nonsmooth", {"abs": {"tanh": 1, "sqrt": 1}}, "/nonsmooth/abs", "either 'tanh' or", ""),
        ("static", {"k": 3}, "/static/k", "expected an object", "bounds, guess"),
        ("stages", {}, "/stages", "expected a list", ""),
        ("accelerations", {}, "/accelerations", "unknown field", "a phase's 'system'"),
        (f"{SYSTEM} states 1", "2q", "/phases/0/system/states/1", "'2q' is not a name", ""),
        (
            f"{SYSTEM} states",
            [f"x{i}" for i in range(MODEL_LIMITS.states + 1)],
            "/phases/0/system/states",
            "over the limit of 'states'",
            "",
        ),
    ],
)
def test_bad_shape(path: str, value: Any, pointer: str, message: str, hint: str) -> None:
    issue = issues(changed(path, value))[0]
    assert issue.pointer == pointer
    assert message in issue.message
    assert hint in issue.hint


@pytest.mark.parametrize(
    ("path", "value", "pointer", "column"),
    [
        (f"{SYSTEM} derivatives v1", "v2 + sine(q1)", "/phases/0/system/derivatives/v1", 6),
        (f"{PHASE} bounds q1", ["1/0", 2], "/phases/0/bounds/q1/0", 2),
        (f"{PHASE} final q1", "1 +", "/phases/0/final/q1", 3),
        ("guess values q1", [0, "2x", 1], "/guess/values/q1/1", 2),
        ("objective minimize", "effort < 1", "/objective/minimize", 8),
        (f"{PHASE} path 0 lower", "sqrt(-1)", "/phases/0/path/0/lower", 1),
    ],
)
def test_bad_expressions_have_a_column(path: str, value: Any, pointer: str, column: int) -> None:
    issue = issues(changed(path, value))[0]
    assert (issue.pointer, issue.column) == (pointer, column)


def test_a_field_named_like_a_kind_is_placed_right() -> None:
    problem = changed("method hermite_simpson", {})
    problem["method"]["segments"] = "x"
    assert {issue.pointer for issue in issues(problem)} == {
        "/method/segments",
        "/method/hermite_simpson",
    }


def test_the_number_of_issues_is_bounded() -> None:
    start = time.perf_counter()
    assert len(issues(changed(f"{PHASE} bounds", {f"x{i}": {} for i in range(9000)}))) == MAX_ISSUES
    assert len(issues(changed(f"{PHASE} bounds", {f"x{i}": 1 for i in range(9000)}))) == MAX_ISSUES
    many = "+".join(f"x{i}" for i in range(600))
    assert len(issues(changed(f"{SYSTEM} derivatives v1", many))) == MAX_ISSUES
    assert time.perf_counter() - start < 5.0


@pytest.mark.parametrize("digits", [101, 308, 5000])
@pytest.mark.parametrize("path", ["phases 0 bounds q1", "phases 0 integrals effort"])
def test_giant_whole_numbers(path: str, digits: int) -> None:
    (issue,) = issues(changed(path, 10**digits))
    assert issue.pointer == "/" + path.replace(" ", "/")
    assert "at most 1e+100" in issue.message


def test_too_much_of_everything() -> None:
    (issue,) = issues(changed("guess values q1", [0] * MODEL_LIMITS.values))
    assert "'values'" in issue.message
    define = {f"z{i}": "+".join(["q1"] * 1000) for i in range(21)}
    (issue,) = issues(changed(f"{SYSTEM} define", define))
    assert "'nodes'" in issue.message


def test_the_published_schema_knows_what_the_edge_puts_in() -> None:
    phase = Problem.model_json_schema()["$defs"]["Phase"]["properties"]
    guesses = phase["guess"]["anyOf"][0]["oneOf"]
    assert guesses[-1]["required"] == ["from_job"]
    system = phase["system"]["oneOf"][-1]
    assert system["properties"]["kind"] == {"const": "library"}
    assert system["required"] == ["kind", "name"]
