"""Absolute values made exact by slacks where the optimum presses these, and smoothed elsewhere."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.errors import BadProblem, InvalidModel
from schemas.expressions import Call, Name, Number, Tree, names_in, parse, walk
from schemas.expressions.signs import sign_of, sign_of_interval
from schemas.expressions.smoothing import NONSMOOTH, smooth, smoothed_size
from schemas.problem import Problem
from schemas.reading import read_problem
from solver.lowering import Slacks, lower, slacks, smoothed
from tests.unit.lowering.forms import complete, value

SLACK = {"abs": "slack"}
SYSTEM: dict[str, Any] = {
    "kind": "ode",
    "parameters": {"gain": 2, "loss": -1},
    "states": ["x", "v"],
    "controls": ["u"],
    "define": {"power": "abs(u*v)", "drive": "u*v", "both": "power + gain*abs(u)"},
    "derivatives": {"x": "v", "v": "u"},
}


def document(
    integrand: str, objective: str = "cost", nonsmooth: Any = SLACK, **phase: Any
) -> dict[str, Any]:
    only = {
        "system": SYSTEM,
        "time": {"final": [1, 2]},
        "bounds": {"x": [0, 1]},
        "integrals": {"cost": integrand, "effort": "u^2"},
        **phase,
    }
    return {"phases": [only], "objective": {"minimize": objective}, "nonsmooth": nonsmooth}


def points(count: int = 200) -> dict[str, np.ndarray]:
    random = np.random.default_rng(1)
    series = dict(zip(("v", "u"), random.uniform(-2, 2, (2, count)), strict=True))
    return {"t": np.linspace(0, 1, count), "x": random.uniform(0, 1, count), **series}


def pressed(problem: Problem) -> tuple[Slacks, dict[str, np.ndarray]]:
    """The slacks of a problem, and everything at random points with each at its best."""
    found, names = slacks(problem, 0), complete(lower(problem)[0], points())
    for name, tree in found.values.items():
        names[name] = value(tree, names)
    return found, names


@pytest.mark.parametrize(
    ("integrand", "objective", "count"),
    [
        ("abs(u*v)", "cost", 1),
        ("power", "cost/duration", 1),
        ("both + abs(u * v)", "cost", 2),
        ("abs(drive) + gain*abs(u)/3", "effort + 2*cost", 2),
        ("loss*abs(u)", "-cost", 1),
        ("x*abs(u)", "cost*final.x", 1),
        ("u^2 - min(u, v, x)", "sqrt(cost)", 1),
        ("max(0, abs(u) - 1, v) + exp(abs(u))", "cost", 2),
        ("abs(u)*abs(v)", "cost^2", 2),
        ("(1 + abs(v))^gain", "cost", 1),
        ("-1/gain*min(-abs(u), v)", "cost", 2),
    ],
)
def test_slacks_take_the_place_of_absolute_values(
    integrand: str, objective: str, count: int
) -> None:
    problem = read_problem(document(integrand, objective))
    found, names = pressed(problem)
    integrands = found.integrals
    assert len(found.names) == count
    assert set(integrands) == {"cost", "effort"}
    assert not uses_any(integrands["cost"], NONSMOOTH | {"power", "both"})
    exact = value(problem.phases[0].integrals["cost"].tree, names)
    assert value(integrands["cost"], names) == pytest.approx(exact, abs=1e-12)
    for tree in found.rows.values():
        assert (value(tree, names) >= -1e-15).all()
    tight = np.min([value(tree, names) for tree in found.rows.values()], axis=0)
    assert tight == pytest.approx(np.zeros_like(tight), abs=1e-12)


def uses_any(tree: Tree, words: frozenset[str]) -> bool:
    used = {node.name if isinstance(node, Name) else node.function for node in walk(tree)
            if not isinstance(node, Number)}  # fmt: skip
    return bool(used & words)


@pytest.mark.parametrize(
    ("integrand", "objective"),
    [("abs(u*v)", "cost"), ("loss*abs(u)", "-cost"), ("u^2 - min(u, v, x)", "cost")],
)
def test_a_slack_off_its_value_breaks_a_row_or_costs(integrand: str, objective: str) -> None:
    found, names = pressed(read_problem(document(integrand, objective)))
    sense = -1 if objective.startswith("-") else 1
    best = sense * value(found.integrals["cost"], names)
    for change in (-0.1, 0.1):
        moved = {**names, "slack(1)": names["slack(1)"] + change}
        rows = np.min([value(tree, moved) for tree in found.rows.values()], axis=0)
        costs = sense * value(found.integrals["cost"], moved)
        assert ((rows < -0.05) | (costs > best + 0.05)).all()


def test_equal_values_share_a_slack_and_no_user_can_name_one() -> None:
    found = slacks(read_problem(document("abs(u*v) + 2*abs( u * v )")), 0)
    assert found.names == ("slack(1)",)
    with pytest.raises(ValueError, match="there is no function 'slack'"):
        parse(found.names[0])


ROW = {"name": "row", "expression": "cost"}


@pytest.mark.parametrize(
    ("integrand", "objective", "boundary", "place", "reason"),
    [
        ("loss*abs(u)", "cost", {}, "/phases/0/integrals/cost, column 6", "objective falls with"),
        ("abs(u)", "-cost", {}, "/phases/0/integrals/cost, column 1", "falls with this abs"),
        ("min(u, v)", "cost", {}, "/phases/0/integrals/cost, column 1", "rises with this min"),
        ("v*abs(u)", "cost", {}, "/phases/0/integrals/cost, column 2", "multiplied by what may be"),
        ("abs(u)/v", "cost", {}, "/phases/0/integrals/cost, column 7", "divided by what may be"),
        ("1/(1 + abs(u))", "cost", {}, "/phases/0/integrals/cost, column 2", "inside of '/'"),
        ("cos(abs(u))", "cost", {}, "/phases/0/integrals/cost, column 1", "inside of 'cos'"),
        ("(abs(u) - 1)^2", "cost", {}, "/phases/0/integrals/cost", "power of what may be negative"),
        ("abs(u - abs(v))", "cost", {}, "/phases/0/integrals/cost, column 1", "holds another one"),
        ("v*both", "cost", {}, "/phases/0/integrals/cost, column 2", "multiplied by what may be"),
        ("-both", "cost", {}, "/phases/0/integrals/cost, column 2", "in 'both', in 'power', the"),
        ("abs(u)", "cost - cost^2", {}, "/objective/minimize, column 8", "both more and less"),
        ("abs(u)", "cost/final.v", {}, "/objective/minimize, column 5", "divided by what may be"),
        ("abs(u)", "abs(cost)", {}, "/objective/minimize, column 1", "integrated along a phase"),
        ("u^2", "cost + abs(final.x)", {}, "/objective/minimize, column 8", "integrated along"),
        ("abs(u)", "cost", {"lower": 1}, "/phases/0/boundary/0/expression", "'cost' against"),
        ("abs(u)", "cost", {"lower": 1, "upper": 2}, "/phases/0/boundary/0/expression", "both"),
    ],
)  # fmt: skip
def test_slacks_that_nothing_presses_are_refused(
    integrand: str, objective: str, boundary: dict[str, int], place: str, reason: str
) -> None:
    rows = [{**ROW, **boundary}] if boundary else []
    given = document(integrand, objective, boundary=rows)
    with pytest.raises(BadProblem) as caught:
        read_problem(given)
    assert [str(issue).startswith(place) for issue in caught.value.issues] == [True]
    issue = caught.value.issues[0]
    assert reason in issue.message
    assert "tanh" in issue.hint
    with pytest.raises(InvalidModel):
        slacks(Problem.model_validate(given), 0)


@pytest.mark.parametrize("row", [{"upper": 3}, {"expression": "-2*cost", "lower": -6}])
def test_a_limit_on_the_side_of_the_objective_is_no_obstacle(row: dict[str, Any]) -> None:
    problem = read_problem(document("abs(u)", boundary=[{**ROW, **row}]))
    assert slacks(problem, 0).names == ("slack(1)",)


@pytest.mark.parametrize(
    ("integrand", "objective"), [("abs(u)", "effort"), ("u*abs(loss)", "abs(gain)*cost")]
)
def test_what_the_objective_does_not_have_stays(integrand: str, objective: str) -> None:
    problem = read_problem(document(integrand, objective))
    found = slacks(problem, 0)
    assert (found.names, dict(found.rows)) == ((), {})
    assert found.integrals["cost"] == problem.phases[0].integrals["cost"].tree


def test_methods_and_motions_without_nodes_for_slacks_are_refused() -> None:
    with pytest.raises(BadProblem, match="multiple shooting integrates between its knots"):
        read_problem(document("abs(u)", method={"kind": "multiple_shooting"}))
    flight = {"kind": "closed_form", "states": {"x": "initial.x + t - initial.t"}}
    with pytest.raises(BadProblem, match="a motion in closed form"):
        read_problem(document("abs(x - 2)", system=flight, integrals={"cost": "abs(x - 2)"}))


def test_intermediates_that_double_are_refused_in_time() -> None:
    define = {"w0": "abs(u)"} | {f"w{i}": f"w{i - 1} + w{i - 1}" for i in range(1, 60)}
    with pytest.raises(BadProblem, match="uses of intermediates"):
        read_problem(document("w59", system={**SYSTEM, "define": define}))


def test_slacks_of_several_phases_are_their_own() -> None:
    one = document("abs(u)")["phases"][0]
    two = {**one, "name": "back", "integrals": {"cost": "2*abs(v)"}, "time": {"duration": 1}}
    given = document("abs(u)", "phase.cost + back.cost + back.final.x")
    problem = read_problem({**given, "phases": [one, two]})
    assert [slacks(problem, index).names for index in (0, 1)] == [("slack(1)",)] * 2
    assert names_in(slacks(problem, 1).integrals["cost"]) == [Name("slack(1)")]


LEAVES = st.sampled_from(["p", "n", "z", "a"]).map(Name) | st.floats(-2, 2).map(Number)
FUNCTIONS = ("neg", "abs", "exp", "tanh", "cosh", "sin", "atan", "sign")


def _grown(inner: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    one = st.builds(lambda f, a: Call(f, (a,)), st.sampled_from(FUNCTIONS), inner)
    two = st.builds(
        lambda f, *a: Call(f, a), st.sampled_from(["+", "-", "*", "/", "min", "max", "hypot"]),
        inner, inner,
    )  # fmt: skip
    power = st.builds(lambda a, n: Call("^", (a, Number(float(n)))), inner, st.integers(-2, 3))
    return one | two | power


@given(st.recursive(LEAVES, _grown, max_leaves=10))
def test_a_sign_that_is_known_is_right(tree: Tree) -> None:
    limits = {"p": (0.0, 3.0), "n": (-3.0, 0.0), "z": (0.0, 0.0), "a": (-3.0, 3.0)}
    sign = sign_of(tree, lambda name: sign_of_interval(*limits[name]))
    random = np.random.default_rng(2)
    here = {name: random.uniform(*sides, 50) for name, sides in limits.items()}
    with np.errstate(all="ignore"):
        found = value(tree, {"first": here["p"], **here})
    found = found[np.isfinite(found)]
    assert sign is None or (np.sign(found) * (sign or 1) >= 0).all()
    assert sign != 0 or not found.any()


@pytest.mark.parametrize(
    ("kind", "width", "exact"),
    [
        ("tanh", 0.1, lambda x: x * np.tanh(x / 0.1)),
        ("sqrt", 0.2, lambda x: np.sqrt(x**2 + 0.04) - 0.2),
    ],
)
def test_smooth_forms_are_those_of_the_books(kind: str, width: float, exact: Any) -> None:
    problem = smoothed(read_problem(document("abs(u) + max(u, v) - min(x, v, u)", "cost",
                                             {"abs": {kind: width}})))  # fmt: skip
    names = points()
    x, v, u = (names[name] for name in "xvu")

    def least(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return (a + b - exact(a - b)) / 2

    expected = exact(u) + (u + v + exact(u - v)) / 2 - least(x, least(v, u))
    tree = problem.phases[0].integrals["cost"].tree
    assert value(tree, names) == pytest.approx(expected, abs=1e-14)


def test_smoothing_is_everywhere_but_in_constants_and_texts() -> None:
    given = document(
        "abs(u)",
        "cost + abs(final.x) + abs(phase.gain)",
        {"abs": {"tanh": 0.1}},
        path=[{"name": "p", "expression": "max(u, abs(loss)*v)", "upper": "abs(-9)"}],
        boundary=[{"name": "b", "expression": "abs(final.x - 1)", "upper": 1}],
        guess={"kind": "constant", "values": {"u": "abs(-1)"}},
    )
    before = read_problem(given)
    after = smoothed(before)
    phase = after.phases[0]
    trees = [phase.system.define["power"].tree, phase.path[0].expression.tree]
    trees += [phase.boundary[0].expression.tree, phase.integrals["cost"].tree]
    assert after.objective is not None
    for tree in (*trees, after.objective.minimize.tree):
        for node in walk(tree):
            if isinstance(node, Call) and node.function in NONSMOOTH:
                assert {name.name for name in names_in(node)} <= {"loss", "phase.gain"}
        assert uses_any(tree, frozenset({"tanh"}))
    assert after == before  # equal by text: results and hashes speak of the user's own problem
    assert smoothed(after).phases[0].integrals["cost"].tree == phase.integrals["cost"].tree


@pytest.mark.parametrize("nonsmooth", [None, SLACK])
def test_a_problem_that_asks_for_no_smoothing_is_itself(nonsmooth: Any) -> None:
    problem = read_problem(document("abs(u)", nonsmooth=nonsmooth))
    assert smoothed(problem) is problem
    if nonsmooth is None:
        assert slacks(problem, 0).names == ()


@pytest.mark.parametrize(
    "text", ["abs(x*(1 + abs(v)))", "max(x, v, u, 3*x, abs(v))", "abs(min(x, v) - 2)^2"]
)
def test_the_size_of_a_smooth_form_is_known_beforehand(text: str) -> None:
    def tanh(tree: Tree, column: int) -> Tree:
        scaled = Call("tanh", (Call("/", (tree, Number(0.1))),))
        return Call("*", (tree, scaled))

    made = smooth(parse(text), tanh, lambda _: False)
    assert sum(1 for _ in walk(made)) <= smoothed_size(parse(text)) < 500


def test_smooth_forms_that_explode_are_refused() -> None:
    nested = "abs(" * 40 + "u" + ")" * 40
    with pytest.raises(BadProblem, match="nest abs, min and max less deeply"):
        read_problem(document(nested, nonsmooth={"abs": {"tanh": 0.1}}))
