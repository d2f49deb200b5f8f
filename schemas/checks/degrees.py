"""Whether residuals are linear in the accelerations."""

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

from schemas.expressions import FUNCTIONS, Expression, Name, fold, names_in, split
from schemas.systems import SecondOrder

_NONLINEAR = 2


def _other(*degrees: int) -> int:
    return _NONLINEAR if any(degrees) else 0


_RULES: Mapping[str, Callable[..., int]] = MappingProxyType(
    {
        "+": max,
        "-": max,
        "neg": lambda degree: degree,
        "*": lambda *degrees: min(sum(degrees), _NONLINEAR),
        "/": lambda numerator, denominator: _NONLINEAR if denominator else numerator,
        "^": _other,
        **dict.fromkeys(FUNCTIONS, _other),
    }
)
"""Function -> the degree of its value from those of its arguments."""


def nonlinear(system: SecondOrder, residual: list[Expression]) -> Iterator[int]:
    """The indices of residuals that are not linear in accelerations, as they are written.

    Sound, and conservative: what cancels counts.
    """
    highest: dict[str, int] = dict.fromkeys(system.coordinates, 0)
    degrees: dict[str, int] = {}

    def order(name: str) -> int:
        """The highest derivative of a coordinate in a name, -1 without any."""
        _, own, base = split(name)
        return highest[base] + own if highest.get(base, -1) >= 0 else -1

    def degree(name: Name) -> int:
        """0 without accelerations, 1 if linear in them; a rate is linear in what it adds."""
        _, own, base = split(name.name)
        if own == 0 and base in degrees:
            return degrees[base]
        return min(max(order(name.name) - 1, 0), _NONLINEAR)

    for name, expression in system.define.items():
        highest[name] = max((order(one.name) for one in names_in(expression.tree)), default=-1)
        degrees[name] = fold(expression.tree, _RULES, degree, _constant)
    for index, expression in enumerate(residual):
        if fold(expression.tree, _RULES, degree, _constant) >= _NONLINEAR:
            yield index


def _constant(_: float) -> int:
    return 0
