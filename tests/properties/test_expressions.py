"""Expressions hold against Python's own arithmetic, and against garbage."""

import math
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.expressions import FUNCTIONS, ExpressionError, constant, names_in, parse
from schemas.expressions.constant import FLOATS
from schemas.expressions.tokens import MAX_CONSTANT

NAMES = {"x": 0.7, "y": -1.3, "final.q": 2.5, "initial.dd(q)": 0.3, "d(q)": -0.9}
ENVIRONMENT: dict[str, Any] = {name: FLOATS[name] for name in FUNCTIONS}
ENVIRONMENT |= {
    "abs": math.fabs,
    "x": 0.7,
    "y": -1.3,
    "final_q": 2.5,
    "initial_dd_q": 0.3,
    "d_q": -0.9,
    "pi": math.pi,
    "__builtins__": {},
}

numbers = st.floats(0, 100, allow_subnormal=False).map(repr)
leaves = numbers | st.sampled_from([*NAMES, "pi"])


def _branches(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    one = [name for name, arity in FUNCTIONS.items() if arity == (1, 1)]
    two = [name for name, arity in FUNCTIONS.items() if arity != (1, 1)]
    operators = st.sampled_from([" + ", "-", "*", " / ", "^", "**"])
    return st.one_of(
        st.builds("{}{}{}".format, inner, operators, inner),
        st.builds("{}{}({})".format, inner, operators, inner),
        st.builds("({})".format, inner),
        st.builds("-{}".format, inner),
        st.builds("{}({})".format, st.sampled_from(one), inner),
        st.builds("{}({}, {})".format, st.sampled_from(two), inner, inner),
    )


formulas = st.recursive(leaves, _branches, max_leaves=25)


def _by_python(text: str) -> float:
    """What Python makes of the text; NaN where that is no real number."""
    python = text.replace("^", "**").replace("final.q", "final_q")
    python = python.replace("initial.dd(q)", "initial_dd_q").replace("d(q)", "d_q")
    try:
        value = eval(python, ENVIRONMENT)  # noqa: S307 - the text is this test's own
    except (ValueError, ZeroDivisionError, OverflowError, TypeError):
        return math.nan
    return math.nan if isinstance(value, complex) else float(value)


def _refusal(text: str) -> ExpressionError | None:
    try:
        parse(text)
    except ExpressionError as error:
        return error
    return None


@given(formulas)
@settings(max_examples=500, deadline=None)
def test_the_value_is_that_of_python(text: str) -> None:
    expected = _by_python(text)
    try:
        value = constant(parse(text), NAMES)
    except ExpressionError as error:
        ours = f"{MAX_CONSTANT:g}" in error.message or "exponent" in error.message
        assert math.isnan(expected) or ours
    else:
        assert value == expected


@given(formulas)
@settings(deadline=None)
def test_names_stand_where_they_are_said_to(text: str) -> None:
    try:
        tree = parse(text)
    except ExpressionError:
        return
    for name in names_in(tree):
        assert text[name.column - 1 :].startswith(name.name)


@given(st.text() | st.text("xyqdsinlog2.(),+-*/^ e0\n\t", max_size=200))
@settings(max_examples=500, deadline=None)
def test_garbage_raises_nothing_but_its_own_error(text: str) -> None:
    error = _refusal(text)
    if error is not None:
        assert 1 <= error.column <= max(1, len(text))
        assert error.message.isascii()
        assert error.message.isprintable()
