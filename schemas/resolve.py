"""The numbers behind a problem's constants: parameters, scalars and bounds.

The checks of `schemas.reading` have been through all of them, so nothing here fails for a
problem that was read.
"""

import math
from collections.abc import Mapping

from schemas.expressions import Expression, constant
from schemas.phases import Constraint
from schemas.systems import System
from schemas.values import Bound, Scalar


def parameters(system: System) -> dict[str, float]:
    """The value of each parameter, in order; one may use those before it.

    Raises
    ------
    ExpressionError
        Where one cannot be evaluated.
    """
    values: dict[str, float] = {}
    for name, value in system.parameters.items():
        values[name] = scalar(value, values)
    return values


def scalar(value: Scalar, names: Mapping[str, float]) -> float:
    """The number that ``value`` stands for, with ``names`` as the known constants.

    Raises
    ------
    ExpressionError
        Where it cannot be evaluated.
    """
    if isinstance(value.source, Expression):
        return constant(value.source.tree, names)
    return value.source


def interval(limited: Bound | Constraint | None, names: Mapping[str, float]) -> tuple[float, float]:
    """Lower and upper limit; open sides, and a bound that is not there, are infinite.

    Raises
    ------
    ExpressionError
        Where a side cannot be evaluated.
    """
    if limited is None:
        return -math.inf, math.inf
    lower = -math.inf if limited.lower is None else scalar(limited.lower, names)
    upper = math.inf if limited.upper is None else scalar(limited.upper, names)
    return lower, upper
