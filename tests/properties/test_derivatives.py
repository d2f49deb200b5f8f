"""What the language lets pass of derivatives can be lowered, and what it refuses cannot."""

from typing import Any

from hypothesis import event, given, settings
from hypothesis import strategies as st

from schemas.errors import BadProblem, InvalidModel
from schemas.expressions import derivative
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.lowering import lower, lower_native

orders = st.sampled_from([0, 0, 1, 1, 2, 3])


def sums(bases: list[str]) -> st.SearchStrategy[str]:
    names = st.builds(derivative, st.sampled_from(bases), orders)
    terms = st.builds(str.format, st.sampled_from(["sin({})", "{}", "u*{}"]), names)
    return st.lists(terms, min_size=1, max_size=2).map(" + ".join)


@st.composite
def problems(draw: st.DrawFn) -> dict[str, Any]:
    anything = sums(["x", "y", "u", "a", "b"])
    system: dict[str, Any] = {
        "controls": ["u"],
        "define": {"a": draw(sums(["x", "y", "u"])), "b": draw(sums(["x", "y", "u", "a"]))},
    }
    x, y = draw(anything), draw(anything)
    kind = draw(st.sampled_from(["derivatives", "accelerations", "residual"]))
    if kind == "derivatives":
        system |= {"kind": "ode", "states": ["x", "y"], "derivatives": {"x": x, "y": y}}
    else:
        system |= {"kind": "second_order", "coordinates": ["x", "y"]}
        pair = [f"dd(x) + {x}", f"dd(y) + {y}"]
        system[kind] = pair if kind == "residual" else {"x": x, "y": y}
    phase = {"system": system, "time": {"duration": 1}, "integrals": {"e": draw(anything)}}
    return {"phases": [phase], "objective": {"minimize": "e"}}


def lowers(problem: Problem) -> bool:
    try:
        lower(problem)
    except InvalidModel:
        return False
    return True


@given(problems())
@settings(max_examples=300, deadline=None)
def test_what_is_let_pass_can_be_lowered(document: dict[str, Any]) -> None:
    try:
        problem = read_problem(document)
    except BadProblem as bad:
        event("refused")
        too_high = all("too high" in issue.message for issue in bad.issues)
        assert too_high or not lowers(Problem.model_validate(document))
    else:
        event("read")
        assert lowers(problem)


@given(problems())
@settings(max_examples=300, deadline=None)
def test_what_is_let_pass_has_a_native_form(document: dict[str, Any]) -> None:
    document["method"] = {"kind": "dircol5i"}
    try:
        problem = read_problem(document)
    except BadProblem:
        return
    event("read")
    assert lower_native(problem, 0).residuals
