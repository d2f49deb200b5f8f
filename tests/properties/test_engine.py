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
BOUNDS = st.one_of(
    st.sampled_from([0, 1, [-1, 1], [-3, 2], [0, None], [None, 4], [1e-6, 1e4], [None, None]]),
    st.lists(st.sampled_from([-3, -1, 0, 0.5, 1, 2, 1e4]), min_size=2, max_size=2).map(sorted),
)
TIMES = [
    {"final": 1},
    {"final": [0.1, 3]},
    {"final": [0, None]},
    {"duration": 1},
    {"duration": [0.1, 2], "final": [None, 2]},
    {"duration": [0.5, None]},
]
LATER = [*TIMES[3:], {"final": 4}, {"duration": [0, 1], "final": [None, 5]}]
"""Of a first phase, and of those after it."""

SYSTEMS: dict[str, tuple[list[str], list[str]]] = {
    "ode": (["x", "v"], ["u", "d(u)", "d(x)"]),
    "explicit": (["x", "d(x)"], ["u", "d(u)", "dd(x)", "ddd(x)"]),
    "residual": (["x", "d(x)"], ["u", "d(u)", "dd(x)", "ddd(x)"]),
    "closed": (["x", "v"], []),
}
"""Kind of system -> its states, and what else may be said of it along a phase."""


def expressions(*leaves: str) -> st.SearchStrategy[str]:
    return st.recursive(
        st.sampled_from([*leaves, "t", "1", "0", "2", "0.1"]),
        lambda inner: st.one_of(
            st.builds("({} {} {})".format, inner, st.sampled_from(["+", "-", "*", "/"]), inner),
            st.builds(
                "{}({})".format,
                st.sampled_from(["sin", "sqrt", "log", "exp", "abs", "tanh"]),
                inner,
            ),
            st.builds("({})^{}".format, inner, st.sampled_from(["2", "3", "0.5", "-1"])),
        ),
        max_leaves=6,
    )


def methods() -> st.SearchStrategy[dict[str, Any]]:
    return st.builds(
        lambda method, segments: {**method, "segments": segments},
        st.sampled_from(variants(second_order=True)),
        st.integers(1, 4),
    )


def guesses(names: list[str]) -> st.SearchStrategy[dict[str, Any]]:
    return st.one_of(
        st.just({"kind": "linear"}),
        st.builds(lambda seed: {"kind": "random", "seed": seed, "spread": 1}, st.integers(0, 99)),
        st.dictionaries(st.sampled_from(names), NUMBERS).map(
            lambda values: {"kind": "constant", "values": values}
        ),
    )


def system(draw: st.DrawFn, kind: str, static: list[str]) -> dict[str, Any]:
    first, _ = SYSTEMS[kind]
    motion = expressions(*first, "u", *static)
    if kind == "ode":
        derivatives = {name: draw(motion) for name in first}
        return {"kind": "ode", "states": first, "controls": ["u"], "derivatives": derivatives}
    if kind == "closed":
        since = draw(expressions("initial.v", *static))
        states = {"x": f"initial.x + (t - initial.t)*({since})", "v": "initial.v"}
        return {"kind": "closed_form", "states": states}
    shared = {"kind": "second_order", "coordinates": ["x"], "controls": ["u"]}
    if kind == "explicit":
        return {**shared, "accelerations": {"x": draw(motion)}}
    inertia = draw(st.sampled_from(["1", "(2 + sin(x))", "x", "(1 + dd(x)^2)"]))
    return {**shared, "residual": [f"{inertia}*dd(x) - ({draw(motion)})"]}


def phase(draw: st.DrawFn, name: str, static: list[str]) -> dict[str, Any]:
    kind = draw(st.sampled_from(list(SYSTEMS)))
    states, others = SYSTEMS[kind]
    limited = st.sampled_from([*states, *others])
    ends = st.dictionaries(limited, BOUNDS, max_size=3)
    along = expressions(*states, *others, *static)
    built: dict[str, Any] = {
        "name": name,
        "system": system(draw, kind, static),
        "time": draw(st.sampled_from(TIMES if name == "a" else LATER)),
        "bounds": draw(st.dictionaries(limited, BOUNDS, max_size=2)),
        "initial": draw(ends),
        "final": draw(ends),
        "integrals": {"cost": draw(along)},
    }
    if draw(st.booleans()):
        built["path"] = [{"name": "p", "expression": draw(along), "lower": draw(NUMBERS)}]
        built["boundary"] = [{"name": "b", "expression": "final.x*cost", "upper": draw(NUMBERS)}]
    if kind != "closed" and draw(st.booleans()):
        built["method"] = draw(methods())
    if draw(st.booleans()):
        built["guess"] = draw(guesses(["x", *([] if kind == "closed" else ["u"])]))
    return built


@st.composite
def problems(draw: st.DrawFn) -> dict[str, Any]:
    static = draw(st.sampled_from([[], ["p"]]))
    names = draw(st.sampled_from([["a"], ["a", "b"]]))
    phases = [phase(draw, name, static) for name in names]
    last = names[-1]
    objectives = ["a.cost", "a.duration", "a.final.x", "-a.final.x", "a.cost^2 + a.duration", "0"]
    objectives += [f"{last}.cost", f"{last}.initial.x^2", *static]
    links = ["a.final.x - b.initial.x", "a.final.x - b.initial.x^2", "a.duration - b.duration"]
    linkages = [
        {"name": f"link{index}", "expression": text, "lower": 0, "upper": 0}
        for index, text in enumerate(draw(st.lists(st.sampled_from(links), max_size=2)))
    ]
    return {
        "static": {name: {"bounds": draw(BOUNDS)} for name in static},
        "phases": phases,
        "linkages": linkages if len(names) > 1 else [],
        "objective": {"minimize": draw(st.sampled_from(objectives))},
        "method": draw(methods()),
        "guess": draw(guesses(["x"])),
        "refinement": draw(st.sampled_from([None, {"max_iterations": 2, "max_segments": 12}])),
        "nonsmooth": draw(st.sampled_from([None, {"abs": "slack"}, {"abs": {"tanh": 0.1}}])),
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
