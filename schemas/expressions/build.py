"""Makes the nodes of a tree: constants folded, arity and exponents checked."""

from collections.abc import Sequence

from schemas.expressions.constant import apply
from schemas.expressions.errors import ExpressionError, quoted
from schemas.expressions.tokens import MAX_EXPONENT
from schemas.expressions.tree import FUNCTIONS, Call, Number, Tree
from schemas.suggest import did_you_mean

_OTHER_NAMES = {
    "ln": "log(x)",
    "pow": "x^y",
    "square": "x^2",
    "fabs": "abs(x)",
    "sgn": "sign(x)",
    **{f"arc{name}": f"a{name}(x)" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")},
    "arctan2": "atan2(y, x)",
    "log2": "log(x)/log(2)",
    "norm": "hypot(x, y)",
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "cot": "1/tan(x)",
    **dict.fromkeys(("radians", "deg2rad"), "x*pi/180"),
    **dict.fromkeys(("degrees", "rad2deg"), "x*180/pi"),
    **dict.fromkeys(
        ("integral", "integrate"), "it into the phase's 'integrals', under a name to be used here"
    ),
}


def operation(operator: str, arguments: Sequence[Tree], column: int) -> Tree:
    """An operator over its arguments; leading constants of sums and products are folded."""
    if operator == "^":
        _check_exponent(arguments[1], column)
    if operator == "/" and isinstance(arguments[1], Number) and arguments[1].value == 0:
        raise ExpressionError("division by zero", column)
    if operator in ("+", "*"):
        arguments = _fold_leading(operator, arguments, column)
        if len(arguments) == 1:
            return arguments[0]
    return _folded(operator, tuple(arguments), column)


def function(name: str, arguments: Sequence[Tree], column: int) -> Tree:
    """A call of one of the functions that a user may write.

    Raises
    ------
    ExpressionError
        For unknown functions, wrong numbers of arguments, and constants outside of a domain.
    """
    if name not in FUNCTIONS:
        raise _unknown_function(name, column)
    least, most = FUNCTIONS[name]
    if not least <= len(arguments) <= (most or len(arguments)):
        expected = f"{least}" if most == least else f"at least {least}"
        plural = "" if least == 1 else "s"
        raise ExpressionError(
            f"{name} takes {expected} argument{plural}, not {len(arguments)}", column
        )
    return _folded(name, tuple(arguments), column)


def _folded(name: str, arguments: tuple[Tree, ...], column: int) -> Tree:
    values = [argument.value for argument in arguments if isinstance(argument, Number)]
    if len(values) == len(arguments):
        return Number(apply(name, values, column))
    return Call(name, arguments, column)


def _fold_leading(operator: str, arguments: Sequence[Tree], column: int) -> Sequence[Tree]:
    """Fold from the left, as floats would be evaluated; later constants stay in their place."""
    values: list[float] = []
    for argument in arguments:
        if not isinstance(argument, Number):
            break
        values.append(argument.value)
    if len(values) < 2:
        return arguments
    return [Number(apply(operator, values, column)), *arguments[len(values) :]]


def _check_exponent(exponent: Tree, column: int) -> None:
    if isinstance(exponent, Number) and abs(exponent.value) > MAX_EXPONENT:
        raise ExpressionError(
            f"an exponent of {exponent.value:g}, at most {MAX_EXPONENT} in size is allowed", column
        )


def _unknown_function(name: str, column: int) -> ExpressionError:
    hint = did_you_mean(name, FUNCTIONS)
    if name in _OTHER_NAMES:
        hint = f"write {_OTHER_NAMES[name]}"
    default = "to multiply, write *; the functions are " + ", ".join(FUNCTIONS)
    return ExpressionError(f"there is no function {quoted(name)}", column, hint or default)
