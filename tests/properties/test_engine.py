"""Whatever the language admits ends in a solution, or in a refusal that names the place."""

import json
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from schemas.errors import BadProblem, InvalidModel
from schemas.reading import read_problem
from schemas.results import Solution
from solver import solve
from tests.support.methods import variants

NUMBERS = st.sampled_from([0, 1, -1, 0.5, 2, -3, 1e-6, 1e4, "pi/2"])
LEAVES = st.sampled_from(["x", "v", "u", "t", "1", "0", "2", "0.1"])
EXPRESSIONS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(["+", "-", "*", "/"]), inner),
        st.builds(
            "{}({})".format, st.sampled_from(["sin", "sqrt", "log", "exp", "abs", "tanh"]), inner
        ),
        st.builds("({})^{}".format, inner, st.sampled_from(["2", "3", "0.5", "-1"])),
    ),
    max_leaves=6,
)
BOUNDS = st.one_of(NUMBERS, st.tuples(NUMBERS, NUMBERS).map(list), st.just([None, None]))
OBJECTIVES = st.sampled_from(["cost", "duration", "final.x", "-final.v", "cost^2 + duration", "0"])


@st.composite
def problems(draw: st.DrawFn) -> dict[str, Any]:
    names = st.sampled_from(["x", "v", "u"])
    phase = {
        "system": {
            "kind": "ode",
            "states": ["x", "v"],
            "controls": ["u"],
            "derivatives": {"x": draw(EXPRESSIONS), "v": draw(EXPRESSIONS)},
        },
        "time": {"initial": 0, "final": draw(st.sampled_from([1, [0.1, 3], [0, None]]))},
        "bounds": draw(st.dictionaries(names, BOUNDS, max_size=2)),
        "initial": draw(st.dictionaries(names, BOUNDS)),
        "final": draw(st.dictionaries(names, BOUNDS)),
        "integrals": {"cost": draw(EXPRESSIONS)},
    }
    if draw(st.booleans()):
        phase["path"] = [{"name": "p", "expression": draw(EXPRESSIONS), "lower": draw(NUMBERS)}]
        phase["boundary"] = [{"name": "b", "expression": "final.x*cost", "upper": draw(NUMBERS)}]
    return {
        "phases": [phase],
        "objective": {"minimize": draw(OBJECTIVES)},
        "method": {**draw(st.sampled_from(variants())), "segments": draw(st.integers(1, 4))},
        "refinement": draw(st.sampled_from([None, {"max_iterations": 2, "max_segments": 12}])),
        "solver": {"max_iterations": 25},
        "limits": {"seconds": 2},
    }


@given(problems())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_every_admitted_problem_ends_in_words(document: dict[str, Any]) -> None:
    try:
        problem = read_problem(document)
    except BadProblem:
        return
    try:
        solution = solve(problem)
    except InvalidModel as error:
        issues = error.issues
    else:
        assert solution.message
        assert_is_plain_json(solution)
        return
    assert issues
    assert all(issue.pointer and issue.message and issue.hint for issue in issues)


def assert_is_plain_json(solution: Solution) -> None:
    text = solution.model_dump_json()
    json.loads(text, parse_constant=lambda word: (_ for _ in ()).throw(AssertionError(word)))
    assert Solution.model_validate_json(text).status is solution.status
