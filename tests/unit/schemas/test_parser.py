"""Expressions: what they mean, what is refused, and where the blame is put."""

import math
import time

import pytest

from schemas.expressions import (
    FUNCTIONS,
    OPERATORS,
    Call,
    ExpressionError,
    Name,
    Number,
    constant,
    derivative,
    names_in,
    parse,
    split,
    walk,
    warnings_in,
)
from schemas.expressions.constant import FLOATS
from schemas.expressions.tokens import MAX_DEPTH, MAX_LENGTH, MAX_NODES
from schemas.expressions.tree import depth

NAMES = {"x": 3.0, "y": -2.0, "a": 2.0, "b": 3.0, "c": 0.5, "final.q1": 7.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-x^2", -9.0),
        ("(-x)^2", 9.0),
        ("-x**2", -9.0),
        ("2^-1", 0.5),
        ("a^b^c", 2.0 ** (3.0**0.5)),
        ("(a^b)^c", math.sqrt(8.0)),
        ("2*x^2", 18.0),
        ("2^-x^2", 2.0**-9),
        ("x - y - 1", 4.0),
        ("x - (y - 1)", 6.0),
        ("x / y / 2", -0.75),
        ("x / y * 2", -3.0),
        ("x*y/2*c", -1.5),
        ("+x - -y", 1.0),
        ("1 - x + y - 4", -8.0),
        ("final.q1 * 2", 14.0),
        ("2*pi", 2 * math.pi),
        ("1e-3 + .5 + 2.", 2.501),
        ("007", 7.0),
        ("\tx +\n  y\r\n", 1.0),
        ("min(x, y, 1)", -2.0),
        ("max(x, y)", 3.0),
        ("sign(y)*abs(y)", -2.0),
        ("sign(x - 3)", 0.0),
        ("atan2(y, x) + hypot(3, 4)", math.atan2(-2.0, 3.0) + 5.0),
        ("sqrt(x + 1)", 2.0),
        ("log10(1000)", 3.0),
    ],
)
def test_value(text: str, value: float) -> None:
    assert constant(parse(text), NAMES) == pytest.approx(value, rel=1e-15)


def test_constants_are_folded() -> None:
    assert parse("2*pi*3") == Number(2 * math.pi * 3)
    assert parse("2*pi*x") == Call("*", (Number(2 * math.pi), Name("x", 6)), 5)
    assert parse("-3") == Number(-3.0)


def test_sums_and_products_are_flat() -> None:
    tree = parse("+".join(["x"] * 500))
    assert isinstance(tree, Call)
    assert len(tree.arguments) == 500
    assert depth(parse("x" + " - x" * 500)) == 3
    assert depth(parse("x" + "*y" * 500)) == 2


def test_names_keep_their_columns() -> None:
    names = names_in(parse("x^2 ^ y + sin( final.q1 )"))
    assert [(name.name, name.column) for name in names] == [("x", 1), ("y", 7), ("final.q1", 16)]


def test_a_derivative_is_one_name() -> None:
    names = names_in(parse("2*d(x) + s.final.dd( q )^2/dddd(final_) - d*dx"))
    assert [(name.name, name.column) for name in names] == [
        *(("d(x)", 3), ("s.final.dd(q)", 10), ("dddd(final_)", 28), ("d", 43), ("dx", 45))
    ]


def test_names_are_taken_apart_and_derived() -> None:
    assert split("stance.final.dd(q)") == ("stance.final.", 2, "q")
    assert split("stance.q") == ("stance.", 0, "q")
    assert split("d(q)") == ("", 1, "q")
    assert derivative("q", 0) == "q"
    assert derivative("final.d(q)", 2) == "final.ddd(q)"
    assert derivative("dd(q)", -1) == "d(q)"


def test_walk_goes_from_left_to_right_parents_first() -> None:
    nodes = list(walk(parse("x*sin(y)")))
    assert [getattr(node, "function", getattr(node, "name", "")) for node in nodes] == [
        *("*", "x", "sin", "y")
    ]


@pytest.mark.parametrize(
    ("text", "column", "message", "hint"),
    [
        ("", 1, "empty", ""),
        ("x +", 3, "a value is missing after '+'", ""),
        ("* x", 1, "a value is missing before '*'", ""),
        ("x ^^ y", 4, "a value is missing before '^'", ""),
        ("2x", 2, "an operator is missing", "2*x"),
        ("2 (x)", 3, "an operator is missing", "*"),
        ("(x)(y)", 4, "an operator is missing", "*"),
        ("0x10", 2, "an operator is missing", ""),
        ("1_000", 2, "an operator is missing", ""),
        ("(x", 1, "never closed", ""),
        ("x)", 2, "closes nothing", ""),
        ("()", 2, "a value is missing", ""),
        ("(x, y)", 3, "comma", ""),
        ("x, y", 2, "comma", ""),
        ("min(x, y,)", 10, "a value is missing before ')'", ""),
        ("min(*x)", 5, "a value is missing before '*'", ""),
        ("x < 1", 3, "comparisons", "constraint"),
        ("x == 1", 3, "comparisons", "constraint"),
        ("x in y", 3, "comparisons", ""),
        ("x if y else 1", 3, "conditions", "tanh"),
        ("x and y", 3, "conditions", ""),
        ("True", 1, "conditions", ""),
        ("None", 1, "None", ""),
        ("lambda x", 1, "functions cannot be defined", "define"),
        ("lambda x: x", 9, "':'", "define"),
        ("(x := 1)", 4, "':'", ""),
        ("x[0]", 2, "subscripts", ""),
        ("{x}", 1, "braces", ""),
        ("'x'", 1, "strings", ""),
        ('f"{x}"', 2, "strings", ""),
        ("x & y", 3, "bitwise", ""),
        ("x % y", 3, "remainders", ""),
        ("x // y", 3, "floor division", "a/b"),
        ("x @ y", 3, "matrix", ""),
        ("x # y", 3, "comments", ""),
        ("x; y", 2, "one formula", "define"),
        ("x \\ y", 3, "not part of the language", ""),
        ("x\x00", 2, "not part of the language", ""),
        ("(x).real", 4, "a dot", ""),
        ("x . y", 3, "a dot", ""),
        ("...", 1, "a dot", ""),
        ("2 * \u03c0", 5, "not ASCII", "pi"),
        ("x\u00b2", 2, "not ASCII", "^2"),
        ("x + sine(y)", 5, "no function 'sine'", "did you mean 'sin'?"),
        ("90deg", 3, "an operator is missing", "90*pi/180"),
        ("sin(radians(x))", 5, "no function 'radians'", "x*pi/180"),
        ("sec(x)", 1, "no function 'sec'", "1/cos(x)"),
        ("integral(u^2)", 1, "no function 'integral'", "'integrals'"),
        ("ln(x)", 1, "no function 'ln'", "log(x)"),
        ("arctan2(y, x)", 1, "no function", "atan2"),
        ("m(1 + 2)", 1, "no function 'm'", "to multiply"),
        ("x.__class__()", 1, "no function", ""),
        ("d(x^2)", 3, "d takes one bare name", "in 'define'"),
        ("d(2)", 3, "d takes one bare name", "in 'define'"),
        ("d()", 3, "d takes one bare name", "in 'define'"),
        ("d(x, y)", 3, "d takes one bare name", "in 'define'"),
        ("1 + d((x))", 7, "d takes one bare name", "in 'define'"),
        ("d(d(x))", 3, "d takes one bare name", "write dd(x)"),
        ("dd(dd( q ))", 4, "dd takes one bare name", "write dddd(q)"),
        ("dd(ddd(x))", 4, "dd takes one bare name", "in 'define'"),
        ("d(d(x) + 1)", 3, "d takes one bare name", "in 'define'"),
        ("final.d(d(x))", 9, "final.d takes one bare name", "write final.dd(x)"),
        ("d(final.x)", 3, "without a prefix", "write final.d(x)"),
        ("dd(a.initial.x)", 4, "without a prefix", "write a.initial.dd(x)"),
        ("x*ddddd(x)", 3, "'ddddd': derivatives end at order 4", "in 'define'"),
        ("d(pi)", 3, "'pi' is no name that varies", "in 'define'"),
        ("d(sin)", 3, "'sin' is no name that varies", "in 'define'"),
        ("d(x)(y)", 5, "an operator is missing", "*"),
        ("d(x", 2, "never closed", ""),
        ("sin + 1", 1, "'sin' is a function", "sin(...)"),
        ("x*sin()", 3, "sin takes 1 argument, not 0", ""),
        ("atan2(x)", 1, "atan2 takes 2 arguments, not 1", ""),
        ("min(x)", 1, "min takes at least 2 arguments", ""),
        ("x/0", 2, "division by zero", ""),
        ("x^2/(1 - 1)", 4, "division by zero", ""),
        ("x + 0^-1", 6, "not a real number", ""),
        ("log(0)", 1, "log(0) is not a real number", ""),
        ("x + sqrt(-1)", 5, "sqrt(-1) is not a real number", ""),
        ("(-8)^(1/3)", 5, "(-8)^(0.333333) is not a real number", ""),
        ("9**9**9", 2, "exponent", ""),
        ("x^65", 2, "exponent", ""),
        ("x^-64.5", 2, "exponent", ""),
        ("1e101*x", 1, "constant over", ""),
        ("9" * 400, 1, "constant over", ""),
        ("1e99*1e99", 5, "constant over", ""),
        ("exp(1000)", 1, "constant over", ""),
    ],
)
def test_refused(text: str, column: int, message: str, hint: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse(text)
    assert message in caught.value.message
    assert hint in caught.value.hint
    assert caught.value.column == column


@pytest.mark.parametrize(
    "text",
    [
        "(" * 100_000,
        "(" * 2000,
        "(" * (MAX_DEPTH + 1) + "x" + ")" * (MAX_DEPTH + 1),
        "-" * 3900 + "x",
        "+" * 3900 + "x",
        "x" + "^x" * 1400,
        "x" + "/x" * 1400,
        "x+" * 1700 + "x",
        "sin(" * 700 + "x" + ")" * 700,
        "9**" * 1000 + "9",
        "x" * 10_000_000,
        "a." * 1900 + "a + ",
    ],
    ids=lambda text: f"{text[:8]}..{len(text)}",
)
def test_bombs_are_refused_at_once(text: str) -> None:
    start = time.perf_counter()
    with pytest.raises(ExpressionError):
        parse(text)
    assert time.perf_counter() - start < 1.0


def test_limits_are_met_from_below() -> None:
    assert depth(parse("sin(" * (MAX_DEPTH - 1) + "x" + ")" * (MAX_DEPTH - 1))) == MAX_DEPTH
    assert parse(" " * (MAX_LENGTH - 1) + "x") == Name("x", MAX_LENGTH)
    assert sum(1 for _ in walk(parse("x" + "+x" * (MAX_NODES - 2)))) == MAX_NODES
    assert depth(parse("x^64 + x^-64")) == 3


def test_every_function_has_its_float() -> None:
    assert set(FLOATS) == set(FUNCTIONS) | set(OPERATORS)


def test_unknown_constants_are_placed() -> None:
    with pytest.raises(ExpressionError, match="'mas1'") as caught:
        constant(parse("2 * mas1"), {"mass1": 1.0})
    assert caught.value.column == 5
    assert caught.value.hint == "did you mean 'mass1'?"


@pytest.mark.parametrize("word", ["free", "inf", "Infinity", "None_", "open"])
def test_words_for_open_are_told_null(word: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        constant(parse(word), {})
    assert ("null is open" in caught.value.hint) == (word != "None_")


def test_a_constant_may_fail_on_its_values() -> None:
    with pytest.raises(ExpressionError, match="division by zero") as caught:
        constant(parse("1 + 1/(x - 3)"), NAMES)
    assert caught.value.column == 6


def test_what_is_not_smooth_is_noted_once() -> None:
    notes = warnings_in(parse("abs(x) + abs(y) + sqrt(x^2) + min(x, y) + sign(x)"))
    assert [note.split()[0] for note in notes] == ["abs", "sqrt", "min", "sign"]
    assert warnings_in(parse("sin(x)^2 + sqrt(2)*x")) == []
    assert warnings_in(parse("abs(x) + sqrt(x)"), {"abs"}) == warnings_in(parse("sqrt(x)"))
