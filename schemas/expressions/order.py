"""The order in which tokens may follow each other.

What passes is well formed: Python's parser, which comes next, meets names, operators, commas
and balanced parentheses of a bounded depth, and nothing else.
"""

from schemas.expressions.errors import ExpressionError, quoted
from schemas.expressions.tokens import MAX_DEPTH, TOO_LARGE, Token

_DEGREES = frozenset({"deg", "degree", "degrees"})
_UNITS = frozenset({"kg", "g", "m", "cm", "mm", "km", "s", "ms", "N", "Nm", "rad", "Hz", "J", "W"})


def check_order(tokens: list[Token]) -> None:
    """Hold the tokens to the order: values and operators take turns, parentheses match.

    Raises
    ------
    ExpressionError
        For missing operators and values, commas outside of calls, and parentheses that do not
        match or nest too deep.
    """
    opened: list[tuple[Token, bool]] = []  # and whether it holds the arguments of a call
    before: Token | None = None
    for token in tokens:
        value = _ends_value(before)
        if token.kind != "operator" or token.text == "(":
            call = token.text == "(" and before is not None and before.kind == "name"
            if value and before is not None and not call:
                raise _missing_operator(before, token)
            if token.text == "(":
                opened.append((token, call))
        elif token.text == ")":
            _check_closing(token, before, opened)
            opened.pop()
        elif token.text == "," and not (opened and opened[-1][1]):
            raise ExpressionError(
                "a comma stands only between the arguments of a call", token.column
            )
        elif not value and token.text not in ("+", "-"):
            raise ExpressionError(f"a value is missing before '{token.text}'", token.column)
        if len(opened) > MAX_DEPTH:
            raise ExpressionError(
                f"parentheses nested deeper than {MAX_DEPTH}", token.column, TOO_LARGE
            )
        before = token
    _check_end(before, opened)


def _ends_value(token: Token | None) -> bool:
    return token is not None and (token.kind != "operator" or token.text == ")")


def _check_closing(token: Token, before: Token | None, opened: list[tuple[Token, bool]]) -> None:
    if not opened:
        raise ExpressionError("')' closes nothing", token.column, "add '(' or take it away")
    empty_call = before is opened[-1][0] and opened[-1][1]
    if not _ends_value(before) and not empty_call:
        raise ExpressionError("a value is missing before ')'", token.column)


def _check_end(last: Token | None, opened: list[tuple[Token, bool]]) -> None:
    if last is not None and last.text != "(" and not _ends_value(last):
        raise ExpressionError(f"a value is missing after '{last.text}'", last.column)
    if opened:
        raise ExpressionError("'(' is never closed", opened[-1][0].column, "add ')'")


def _missing_operator(before: Token, token: Token) -> ExpressionError:
    if before.text == "lambda":
        hint = "name an intermediate in 'define' instead"
        return ExpressionError("functions cannot be defined here", before.column, hint)
    hint = "to multiply, write *"
    if token.text in _DEGREES:
        hint = "angles are in radians: write 90*pi/180 for 90 degrees"
    elif token.text != "(" and before.text != ")":
        hint = f"to multiply, write {quoted(before.text)[1:-1]}*{quoted(token.text)[1:-1]}"
        if before.kind == "number" and token.text in _UNITS:
            hint = f"units are SI and left out: write {before.text[-60:]}; {hint}"
    return ExpressionError(
        f"an operator is missing between '{before.text[-60:]}' and '{token.text[:60]}'",
        token.column,
        hint,
    )
