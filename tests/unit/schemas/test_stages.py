"""Stages: patches that make problems."""

import json
from typing import Any

import pytest

from schemas.errors import Issue
from schemas.methods import Radau
from schemas.reading import canonical, read_problem
from schemas.stages import apply_stage, merged
from tests.support.problems import changed, hop, issues


def only(stages: list[Any], **fields: Any) -> Issue:
    (issue,) = issues(hop() | {"stages": stages} | fields)
    return issue


@pytest.mark.parametrize(
    ("target", "patch", "result"),
    [  # from RFC 7396, appendix A
        ({"a": "b"}, {"a": "c"}, {"a": "c"}),
        ({"a": "b"}, {"b": "c"}, {"a": "b", "b": "c"}),
        ({"a": "b"}, {"a": None}, {}),
        ({"a": "b", "b": "c"}, {"a": None}, {"b": "c"}),
        ({"a": ["b"]}, {"a": "c"}, {"a": "c"}),
        ({"a": "c"}, {"a": ["b"]}, {"a": ["b"]}),
        ({"a": {"b": "c"}}, {"a": {"b": "d", "c": None}}, {"a": {"b": "d"}}),
        ({"a": [{"b": "c"}]}, {"a": [1]}, {"a": [1]}),
        ({"a": "foo"}, None, None),
        ({"e": None}, {"a": 1}, {"e": None, "a": 1}),
        ([1, 2], {"a": "b", "c": None}, {"a": "b"}),
        ({}, {"a": {"bb": {"ccc": None}}}, {"a": {"bb": {}}}),
        # ours
        ({"kind": "x", "a": 1}, {"kind": "y", "b": 2}, {"kind": "y", "b": 2}),
        ({"kind": "x", "a": 1}, {"kind": "x", "b": 2}, {"kind": "x", "a": 1, "b": 2}),
        ({"kind": [0, 1], "a": 1}, {"kind": "pi"}, {"kind": "pi", "a": 1}),
        ([{"name": "p"}, {"name": "q"}], {"p": {"a": 2}, "q": None}, [{"name": "p", "a": 2}]),
        ([{"name": "p"}], {"q": {"a": 2}}, [{"name": "q", "a": 2}, {"name": "p"}]),
    ],
)  # fmt: skip
def test_merging(target: Any, patch: Any, result: Any) -> None:
    before = json.dumps(target)
    assert merged(target, patch) == result
    assert json.dumps(target) == before


def test_patches_add_up() -> None:
    problem = read_problem(hop())
    first, second = apply_stage(problem, 0), apply_stage(problem, 1)
    assert first.stages == second.stages == []
    assert first.objective is not None
    assert first.objective.minimize.text == "0"
    assert first.refinement is None
    assert first.guess == problem.guess
    assert second.objective is not None
    assert second.objective.minimize.text == "stance.effort"
    assert second.refinement == problem.refinement
    assert second.guess.kind == "linear"
    assert second.phases[2].guess is None
    assert second.phases[2].method == problem.phases[2].method


def test_a_stored_problem_has_the_same_stages() -> None:
    document = changed("stages", [{"method": {"kind": "radau"}, "refinement": {"merge": False}}])
    problem = read_problem(document)
    again = read_problem(canonical(problem))
    assert apply_stage(again, 0).method == apply_stage(problem, 0).method == Radau(kind="radau")
    assert apply_stage(again, 0).refinement == apply_stage(problem, 0).refinement
    assert apply_stage(problem, 0).refinement != problem.refinement


def test_phases_are_patched_by_name() -> None:
    patch = {
        "phases": {"stance": {"bounds": {"d(u)": None, "u": [0, 1]}}, "landing": {"method": None}}
    }
    stage = apply_stage(read_problem(hop() | {"stages": [patch]}), 0)
    assert [phase.name for phase in stage.phases] == ["stance", "flight", "landing"]
    assert set(stage.phases[0].bounds) == {"y", "d(y)", "u"}
    assert stage.phases[2].method is None


@pytest.mark.parametrize(
    ("stages", "pointer", "message"),
    [
        ([{}, {"metod": {}}], "/stages/1/metod", "unknown field"),
        ([{"objective": {"minimize": "x +"}}], "/stages/0/objective/minimize", "is missing after"),
        ([{"objective": {"minimize": "x"}}], "/stages/0/objective/minimize", "unknown name 'x'"),
        ([{"static": {"k": None}}], "/stages/0", "with this stage, /phases/0/system/acc"),
        (
            [{"phases": {"flight": {"method": {"kind": "radau"}}}}],
            "/stages/0/phases",
            "method: a m",
        ),
        ([{"stages": []}], "/stages/0/stages", "all stages together"),
        ([{"multistart": 3}], "/stages/0/multistart", "all stages together"),
        ([{}, {"limits": {"seconds": 3}}], "/stages/1/limits", "all stages together"),
        ([{}, {"guess": {"kind": "linear"}}], "/stages/1/guess", "the solution of the one before"),
    ],
)
def test_what_is_wrong_with_a_stage(stages: list[Any], pointer: str, message: str) -> None:
    found = issues(hop() | {"stages": stages})[0]
    assert found.pointer == pointer
    assert message in found.message


def test_a_stage_may_mend_nothing_of_the_problem_itself() -> None:
    stages = [{"objective": {"minimize": "0"}}]
    assert only(stages, objective={"minimize": "x"}).pointer == "/objective/minimize"


def test_later_stages_rest_on_earlier_ones() -> None:
    stages = [{"static": {"a": {"bounds": [0, 1]}}}, {"objective": {"minimize": "a"}}]
    problem = read_problem(hop() | {"stages": stages})
    assert "a" in apply_stage(problem, 1).static
    assert only(stages[::-1]).pointer == "/stages/0/objective/minimize"


def test_a_phase_that_is_not_there_is_not_made() -> None:
    issue = only([{"phases": {"stanse": {"bounds": {"y": [0, 2]}}}}])
    assert issue.pointer == "/stages/0/phases/stanse"
    assert (issue.message, issue.hint) == ("there is no phase 'stanse'", "did you mean 'stance'?")
    listed = only([{"phases": [{"bounds": {"y": [0, 2]}}]}])
    assert listed.pointer == "/stages/0/phases"
    assert '{"stance": {...}}' in listed.hint
