"""Trees without the values of their constants: slots stand in for what is constant.

What a value decides stays in the tree: zero, which drops terms, one and minus one, which drop
factors, and exponents, whose derivatives differ in kind.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from schemas.expressions import ExpressionError, Name, Number, Tree
from schemas.expressions.constant import apply
from solver.expressions import FUNCTIONS, SX

Expr = str | int | tuple[Any, ...]
"""A name, a number (a string ``=1.5``), a slot, or a function's name and its arguments."""

_KEPT = (0.0, 1.0, -1.0)
_GROUPED = ("+", "*")


@dataclass(slots=True)
class Slots:
    """Collects constants: ``value_of`` knows them by name, ``values`` has one number per slot.

    Where it is ``closed`` there are no slots: all numbers stay in the trees.
    """

    value_of: Callable[[str], float | None]
    closed: bool = False
    values: list[float] = field(default_factory=list)
    _places: dict[Expr, int] = field(default_factory=dict)

    def expr(self, tree: Tree) -> Expr:
        """The tree with slots where it is constant."""
        found, value = self._split(tree)
        return found if value is None else self._settled(found, value)

    def define(self, tree: Tree) -> tuple[Expr, float | None]:
        """What a name stands for: its number, too, where it is constant."""
        found, value = self._split(tree)
        return (found if value is None else self._settled(found, value)), value

    def _split(self, tree: Tree) -> tuple[Expr, float | None]:
        """The tree as written, and its value; with slots inside where it has none."""
        if isinstance(tree, Name):
            return tree.name, self.value_of(tree.name)
        if isinstance(tree, Number):
            return _number(tree.value), tree.value
        parts = [self._split(argument) for argument in tree.arguments]
        values = [value for _, value in parts if value is not None]
        if not values:
            return (tree.function, *[part for part, _ in parts]), None
        if len(values) == len(parts) and (value := _applied(tree.function, values)) is not None:
            return (tree.function, *[part for part, _ in parts]), value
        return (tree.function, *self._mixed(tree.function, parts)), None

    def _mixed(self, function: str, parts: Sequence[tuple[Expr, float | None]]) -> list[Expr]:
        """Arguments of which some vary; the constants of a sum or product are one."""
        if function == "^" and (exponent := parts[1][1]) is not None:
            return [self._one(*parts[0]), _number(exponent)]
        fixed = [(part, value) for part, value in parts if value is not None]
        if function in _GROUPED and len(fixed) > 1:
            together = _applied(function, [value for _, value in fixed])
            if together is not None:
                whole = self._settled((function, *(part for part, _ in fixed)), together)
                return [whole, *(part for part, value in parts if value is None)]
        return [self._one(*part) for part in parts]

    def _one(self, part: Expr, value: float | None) -> Expr:
        return part if value is None else self._settled(part, value)

    def _settled(self, part: Expr, value: float) -> Expr:
        """A number where its value decides something, or no name is in it; else a slot."""
        if self.closed or value in _KEPT or not _named(part):
            return _number(value)
        if part not in self._places:
            self._places[part] = len(self.values)
            self.values.append(value)
        return self._places[part]


def _number(value: float) -> str:
    return f"={float(value)!r}"


def _named(part: Expr) -> bool:
    """Whether a name is in it."""
    if isinstance(part, tuple):
        return any(_named(one) for one in part[1:])
    return isinstance(part, int) or not part.startswith("=")


def _applied(function: str, values: Sequence[float]) -> float | None:
    """None where there is no such number: then CasADi says so at the values that it meets."""
    try:
        return apply(function, values, 1)
    except ExpressionError:
        return None


def valued(expr: Expr, scope: Mapping[str, SX], slots: Sequence[SX]) -> SX:
    """The expression in CasADi's symbols, ``slots`` in place of its slots."""

    def built(part: Expr) -> SX:
        if isinstance(part, tuple):
            function, *arguments = part
            return FUNCTIONS[function](*map(built, arguments))  # type: ignore[no-any-return]
        if isinstance(part, int):
            return slots[part]
        return SX(float(part[1:])) if part.startswith("=") else scope[part]

    return built(expr)
