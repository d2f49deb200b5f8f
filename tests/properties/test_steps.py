"""Random trees and random mechanisms: slopes are exact, and steps keep their books."""

from typing import Any

import casadi as ca
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.expressions import Call, Name, Number, Tree
from schemas.mechanisms import Mechanism
from solver.discrete.slopes import Slopes
from solver.expressions import SX, evaluate
from tests.properties.test_mechanisms import mechanisms
from tests.support.steps import Steps

COORDINATES = ("x", "y", "z")

leaves = st.one_of(
    st.sampled_from([Name(name) for name in COORDINATES]),
    st.integers(-15, 15).map(lambda n: Number(n / 10)),
)


def _grown(inner: st.SearchStrategy[Tree]) -> st.SearchStrategy[Tree]:
    """Every function, where it is defined and moderate."""

    def call(function: str, *arguments: Tree) -> Tree:
        return Call(function, arguments)

    def positive(tree: Tree) -> Tree:
        return call("+", Number(0.4), call("^", call("sin", tree), Number(2.0)))

    some = st.lists(inner, min_size=2, max_size=3)
    return st.one_of(
        st.tuples(st.sampled_from(["+", "min", "max"]), some).map(lambda a: call(a[0], *a[1])),
        some.map(lambda a: call("*", *(call("tanh", one) for one in a))),
        st.tuples(inner, inner).map(lambda a: call("-", *a)),
        st.tuples(inner, inner).map(lambda a: call("hypot", a[0], positive(a[1]))),
        st.tuples(inner, inner).map(lambda a: call("atan2", positive(a[0]), a[1])),
        st.tuples(st.sampled_from(["sin", "cos", "tanh", "atan", "abs", "neg"]), inner).map(
            lambda a: call(*a)
        ),
        st.tuples(st.sampled_from(["sqrt", "log", "exp", "asin"]), inner).map(
            lambda a: call(a[0], call("*", Number(0.7), positive(a[1])))
        ),
        st.tuples(inner, inner).map(lambda a: call("/", a[0], positive(a[1]))),
        st.tuples(inner, st.sampled_from([2.0, 3.0, -1.0, 0.5, -2.5])).map(
            lambda a: call("^", positive(a[0]), Number(a[1]))
        ),
    )


trees = st.recursive(leaves, _grown, max_leaves=12)
numbers = st.floats(-4, 4, allow_subnormal=False)
places = st.lists(numbers, min_size=3, max_size=3)


@settings(max_examples=300, deadline=None)
@given(trees, places, places)
def test_rows_times_steps_are_changes(tree: Tree, at: list[float], step: list[float]) -> None:
    before, after = SX.sym("before", 3), SX.sym("after", 3)
    named = {name: (before[i], after[i], SX(0)) for i, name in enumerate(COORDINATES)}
    row = Slopes(named, {}, {}).row(tree)
    values = [
        evaluate(tree, {name: side[i] for i, name in enumerate(COORDINATES)})
        for side in (before, after)
    ]
    function = ca.Function("f", [before, after], [row, values[1] - values[0]])
    start, end = np.array(at), np.array(at) + np.array(step)
    slopes, change = (np.array(one).ravel() for one in function(start, end))
    moved = end - start
    scale = 1 + np.abs(slopes) @ np.abs(moved) + np.abs(change[0])
    np.testing.assert_allclose(slopes @ moved, change[0], atol=2e-10 * scale)


@settings(max_examples=40, deadline=None)
@given(mechanisms(), st.sampled_from([0.01, 0.2, 0.5]), st.integers(0, 99))
def test_momentum_times_velocity_is_the_energy_balance(
    mechanism: Mechanism, h: float, seed: int
) -> None:
    steps = Steps(mechanism)
    one = steps.random(seed, h)
    momentum, _, _ = steps.rows(one)
    books = steps.books(one)
    gained = books.kinetic + books.potential + books.damped + books.dissipated
    scale: Any = sum(abs(value) for value in vars(books).values())
    np.testing.assert_allclose(momentum @ one.v1, gained - books.work, atol=1e-11 * scale)
