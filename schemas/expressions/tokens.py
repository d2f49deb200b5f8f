"""Text to tokens; everything that is no part of the language is refused here, by its name."""

import re
from dataclasses import dataclass
from typing import Literal

from schemas.expressions.errors import ExpressionError, quoted

MAX_LENGTH = 4000
MAX_DEPTH = 60
MAX_NODES = 1500
MAX_CONSTANT = 1e100
MAX_EXPONENT = 64

TOO_LARGE = "split it up with named intermediates in 'define'; they cost nothing"

Kind = Literal["number", "name", "operator"]


@dataclass(frozen=True, slots=True)
class Token:
    """A number, a name (dotted names whole) or an operator; both powers are ``^``."""

    kind: Kind
    text: str
    column: int


_TOKEN = re.compile(
    r"""(?P<space>[ \t\r\n]+)
    |(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
    |(?P<name>[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)
    |(?P<operator>\*\*|//|[-+*/^(),])""",
    re.VERBOSE | re.ASCII,
)

_NO_CONDITION = (
    "conditions are not part of the language",
    "min, max, abs and sign are there; for a smooth switch use tanh",
)
_NO_COMPARISON = (
    "comparisons are not part of the language",
    (
        "for an equation write the difference of its sides; a limit is a constraint in 'path' or "
        "'boundary', with 'lower' and 'upper'"
    ),
)
_NO_STRING = ("strings are not part of the language", "write names without quotes")
_NO_BITS = ("bitwise and logical operators are not part of the language", _NO_CONDITION[1])

_REFUSED_SYMBOLS: dict[str, tuple[str, str]] = {
    "//": ("floor division is not part of the language", "write a/b"),
    **dict.fromkeys("<>=!", _NO_COMPARISON),
    **dict.fromkeys("\"'`", _NO_STRING),
    **dict.fromkeys("&|~", _NO_BITS),
    **dict.fromkeys("[]", ("subscripts and lists are not part of the language", "use names")),
    **dict.fromkeys("{}", ("braces are not part of the language", "group with ( and )")),
    ":": ("':' is not part of the language", "name an intermediate in 'define' instead"),
    ";": ("an expression is one formula", "name an intermediate in 'define' instead"),
    "?": _NO_CONDITION,
    "@": ("matrix products are not part of the language", "write a*b"),
    "%": ("remainders are not part of the language", ""),
    "#": ("comments are not part of an expression", "use the problem's 'description'"),
    ".": ("a dot stands only inside a number or a name", "write final.q1, without spaces"),
}
REFUSED_WORDS: dict[str, tuple[str, str]] = {
    **dict.fromkeys(["if", "else", "and", "or", "not", "True", "False"], _NO_CONDITION),
    **dict.fromkeys(["in", "is"], _NO_COMPARISON),
    "for": ("loops are not part of the language", "write the terms out"),
    "None": ("None is not a number", ""),
}
"""Words that no name may be, with the reason and the mend."""

_LOOKALIKES = {
    **dict.fromkeys("\u2212\u2013\u2014", "-"),
    **dict.fromkeys("\u00b7\u22c5\u00d7", "*"),
    "\u00f7": "/",
    "\u03c0": "pi",
    "\u00b2": "^2",
    "\u00b3": "^3",
}


def tokenize(text: str) -> list[Token]:
    """Cut ``text`` into tokens.

    Raises
    ------
    ExpressionError
        For foreign characters and words, and texts over the limits.
    """
    _check_text(text)
    tokens: list[Token] = []
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None or match.group() == "//":
            raise _refused(match.group() if match else text[position], position + 1)
        if match.lastgroup != "space":
            tokens.append(_token(match))
        position = match.end()
    if sum(token.kind != "operator" for token in tokens) > MAX_NODES:
        raise ExpressionError(f"more than {MAX_NODES} names and numbers", 1, TOO_LARGE)
    return tokens


def _check_text(text: str) -> None:
    if len(text) > MAX_LENGTH:
        raise ExpressionError(
            f"{len(text)} characters, at most {MAX_LENGTH} are allowed", MAX_LENGTH + 1, TOO_LARGE
        )
    if not text.isascii():
        place, character = next((i, c) for i, c in enumerate(text) if not c.isascii())
        mend = _LOOKALIKES.get(character)
        raise ExpressionError(
            f"the character {character!a} is not ASCII",
            place + 1,
            f"write {mend}" if mend else "names are letters, digits and _",
        )
    if not text.strip():
        raise ExpressionError("the expression is empty", 1)


def _refused(symbol: str, column: int) -> ExpressionError:
    default = (f"the character {symbol!a} is not part of the language", "")
    message, hint = _REFUSED_SYMBOLS.get(symbol, default)
    return ExpressionError(message, column, hint)


def _token(match: re.Match[str]) -> Token:
    text, column = match.group(), match.start() + 1
    if match.lastgroup == "name":
        if text in REFUSED_WORDS:
            message, hint = REFUSED_WORDS[text]
            raise ExpressionError(f"{quoted(text)}: {message}", column, hint)
        return Token("name", text, column)
    if match.lastgroup == "number":
        if float(text) > MAX_CONSTANT:
            raise ExpressionError(f"a constant over {MAX_CONSTANT:g}", column)
        return Token("number", text, column)
    return Token("operator", "^" if text == "**" else text, column)
