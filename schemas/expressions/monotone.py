"""Replacing parts of an expression that it rises or falls with, whatever the rest of it does."""

from collections.abc import Callable
from dataclasses import dataclass

from schemas.expressions.signs import Sign, product, sign_of
from schemas.expressions.tree import Call, Name, Number, Tree, walk

_RISING = frozenset({"+", "sqrt", "exp", "log", "log10", "sinh", "tanh", "asinh", "atan"})


class Obstacle(Exception):
    """Why an expression does not rise or fall with one of its parts; ``column`` says where."""

    def __init__(self, message: str, column: int | None) -> None:
        super().__init__(message)
        self.message = message
        self.column = column


@dataclass(frozen=True, slots=True)
class Replacement:
    """Which parts are replaced, and by what.

    Attributes
    ----------
    part
        Whether an expression is one.
    replace
        What to put in place of a part, told whether the whole rises with it (else it falls).
    sign
        The sign of a name.
    """

    part: Callable[[Name | Call], bool]
    replace: Callable[[Name | Call, bool], Tree]
    sign: Callable[[str], Sign]

    def concerns(self, tree: Tree) -> bool:
        """Whether an expression holds a part, or is one."""
        return any(not isinstance(node, Number) and self.part(node) for node in walk(tree))


def replaced(tree: Tree, by: Replacement, *, rises: bool = True) -> Tree:
    """The tree with its parts replaced.

    Raises
    ------
    Obstacle
        Where it is not certain whether the whole rises or falls with a part.
    """
    if isinstance(tree, Number) or not by.concerns(tree):
        return tree
    if isinstance(tree, Name) or by.part(tree):
        return by.replace(tree, rises)
    arguments = tuple(
        replaced(one, by, rises=rises == _rises_with(tree, place, by)) if by.concerns(one) else one
        for place, one in enumerate(tree.arguments)
    )
    return Call(tree.function, arguments, tree.column)


def _rises_with(call: Call, place: int, by: Replacement) -> bool:
    """Whether a call rises with its argument at ``place``; False where it falls."""
    function, arguments = call.function, call.arguments
    if function in _RISING or (function == "-" and place == 0):
        return True
    if function in ("neg", "-"):
        return False
    if function == "*":
        others = [one for index, one in enumerate(arguments) if index != place]
        return _positive(product([sign_of(one, by.sign) for one in others]), call)
    if function == "/" and place == 0:
        return _positive(sign_of(arguments[1], by.sign), call)
    if function == "^" and place == 0 and not isinstance(arguments[1], Call):
        return _rises_with_base(call, by)
    raise Obstacle(
        f"it stands inside of '{function}', which does not just rise or fall", call.column
    )


def _rises_with_base(call: Call, by: Replacement) -> bool:
    base, exponent = call.arguments
    odd = isinstance(exponent, Number) and exponent.value > 0 and exponent.value % 2 == 1
    if odd:
        return True
    if sign_of(base, by.sign) != 1:
        raise Obstacle("it stands in a power of what may be negative", call.column)
    return _positive(sign_of(exponent, by.sign), call)


def _positive(sign: Sign, call: Call) -> bool:
    if sign is None:
        verb = {"*": "multiplied", "/": "divided"}.get(call.function, "raised")
        raise Obstacle(f"it is {verb} by what may be positive or negative", call.column)
    return sign >= 0


def without_columns(tree: Tree) -> Tree:
    """The tree as it would be, were it written at another place: for comparisons."""
    if isinstance(tree, Name):
        return Name(tree.name)
    if isinstance(tree, Number):
        return tree
    return Call(tree.function, tuple(map(without_columns, tree.arguments)))
