"""Names as users write them: ``[phase.][initial.|final.]x``, or ``d(x)`` in place of ``x``.

A derivative is a name like any other: the tokens of ``final.dd(q)`` are one `Name`.
"""

from functools import lru_cache
from typing import NamedTuple

from schemas.expressions.errors import ExpressionError, quoted
from schemas.expressions.tokens import Token
from schemas.expressions.tree import FUNCTIONS

MAX_ORDER = 4
DERIVATIVES = tuple("d" * order for order in range(1, MAX_ORDER + 1))
"""``d``, ``dd``, ``ddd`` and ``dddd``. Without an argument these are names like any other."""

_NAME_IT = "name the expression in 'define' and take the derivative of that name"


class Parts(NamedTuple):
    """A name taken apart: ``stance.final.dd(q)`` is ``("stance.final.", 2, "q")``."""

    prefix: str
    order: int
    base: str


@lru_cache(maxsize=10_000)  # the same few names, thousands of times for one problem
def split(name: str) -> Parts:
    """Take a name apart; what is no derivative has order 0."""
    head, _, argument = name.partition("(")
    prefix, dot, last = head.rpartition(".")
    if argument:
        return Parts(prefix + dot, len(last), argument[:-1])
    return Parts(prefix + dot, 0, last)


@lru_cache(maxsize=10_000)
def stem(name: str) -> tuple[int, str]:
    """The order of a derivative and what it is one of, dots and all: (1, "torso.x")."""
    prefix, order, base = split(name)
    return order, prefix + base


@lru_cache(maxsize=10_000)
def derivative(name: str, order: int = 1) -> str:
    """The name of a derivative of ``name``, which may be a derivative: ``dd(q)`` of ``d(q)``."""
    prefix, already, base = split(name)
    total = already + order
    return f"{prefix}{'d' * total}({base})" if total else prefix + base


def join_derivatives(tokens: list[Token]) -> list[Token]:
    """Make one name of every ``d ( x )``, in tokens that `check_order` let pass.

    Raises
    ------
    ExpressionError
        For orders over `MAX_ORDER`, and for arguments that are not one bare name.
    """
    joined: list[Token] = []
    index = 0
    while index < len(tokens):
        token = tokens[index]
        if _order(token) and index + 1 < len(tokens) and tokens[index + 1].text == "(":
            argument = _argument(token, tokens[index + 2 : index + 7])
            joined.append(Token("name", f"{token.text}({argument})", token.column))
            index += 4
        else:
            joined.append(token)
            index += 1
    return joined


def _order(token: Token) -> int:
    last = token.text.rpartition(".")[2]
    return len(last) if token.kind == "name" and not last.strip("d") else 0


def _argument(head: Token, inside: list[Token]) -> str:
    """The name between the parentheses; ``inside`` is what follows the opening one."""
    call, order = head.text, _order(head)
    if order > MAX_ORDER:
        message = f"{quoted(call)}: derivatives end at order {MAX_ORDER}, {DERIVATIVES[-1]}(x)"
        hint = "name a lower one in 'define' and take the derivative of that name"
        raise ExpressionError(message, head.column, hint)
    name, column = inside[0].text, inside[0].column
    if inside[0].kind != "name" or inside[1].text != ")":
        hint, higher = _NAME_IT, order + _order(inside[0])
        if order < higher <= MAX_ORDER and [token.text for token in inside[3:]] == [")", ")"]:
            hint = f"write {call}{name}({inside[2].text})"
        raise ExpressionError(f"{call} takes one bare name, as in {call}(x)", column, hint)
    prefix, _, base = name.rpartition(".")
    if prefix:
        hint = f"write {prefix}.{call}({base})"
        raise ExpressionError(f"{call} takes a name without a prefix", column, hint)
    if name in ("pi", *FUNCTIONS):
        raise ExpressionError(f"{quoted(name)} is no name that varies", column, _NAME_IT)
    return name
