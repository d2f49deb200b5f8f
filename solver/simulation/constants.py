"""The numbers behind a mechanism's constant expressions.

The plane is that of the complex numbers in all of this package: x + iy, and a turn is a product.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from schemas import resolve
from schemas.expressions import Expression, constant
from schemas.mechanisms import Mechanism


@dataclass(frozen=True, slots=True)
class Constants:
    """Parameters and statics by name, and what is made of them."""

    values: Mapping[str, float]

    @classmethod
    def of(cls, mechanism: Mechanism, statics: Mapping[str, float]) -> "Constants":
        """The mechanism's parameters, over the values of the problem's statics."""
        return cls({**statics, **resolve.parameters(mechanism)})

    def number(self, expression: Expression | None, default: float = 0.0) -> float:
        """One number. Raises ExpressionError where it cannot be evaluated."""
        return default if expression is None else constant(expression.tree, self.values)

    def vector(self, pair: Sequence[Expression]) -> complex:
        """A vector of the plane as a complex number, x + iy."""
        return complex(self.number(pair[0]), self.number(pair[1]))

    def unit(self, pair: Sequence[Expression]) -> complex:
        """A vector made one of length one."""
        vector = self.vector(pair)
        return vector / abs(vector)
