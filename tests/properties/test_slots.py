"""Trees with slots for their constants: the same values, whatever the constants are."""

import math
from collections.abc import Mapping

import casadi as ca
from hypothesis import assume, given

from schemas.expressions import Tree
from schemas.expressions.tree import walk
from solver.expressions import SX, scalars
from solver.model.slots import Expr, Slots, valued
from solver.numeric import evaluate
from tests.properties.test_evaluators import TREES, VALUES


def split(tree: Tree, constants: Mapping[str, float]) -> tuple[Expr, list[float]]:
    slots = Slots(constants.get)
    return slots.expr(tree), slots.values


def value(expr: Expr, values: list[float], b: float) -> float:
    """By CasADi, with the values put into the slots afterwards."""
    varying, slots = SX.sym("b"), SX.sym("slots", len(values))
    result = valued(expr, {"b": varying}, scalars(slots))
    return float(ca.Function("tree", [varying, slots], [result])(b, values))


@given(TREES, VALUES, VALUES)
def test_the_value_is_that_of_the_tree(tree: Tree, a: float, b: float) -> None:
    """Away from where rounding decides: every value on the way is finite and of middling size."""
    on_the_way = [abs(evaluate(node, {"a": a, "b": b})) for node in walk(tree)]
    assume(all(math.isfinite(one) and (one == 0 or 1e-6 < one < 1e6) for one in on_the_way))
    found, expected = value(*split(tree, {"a": a}), b), evaluate(tree, {"a": a, "b": b})
    assert math.isclose(found, expected, rel_tol=1e-8, abs_tol=1e-8)


@given(TREES, VALUES, VALUES, VALUES)
def test_equal_shapes_serve_each_other(tree: Tree, a: float, other: float, b: float) -> None:
    """What is built for one constant, with the slots of another one, is what that one builds."""
    (one, values), (two, others) = (split(tree, {"a": constant}) for constant in (a, other))
    if one == two:
        ours, theirs = value(one, others, b), value(two, others, b)
        assert ours == theirs or (math.isnan(ours) and math.isnan(theirs))
    else:
        assert repr(a) != repr(other), "0.0 and -0.0 are two numbers"
    assert len(values) == len(others) or one != two
