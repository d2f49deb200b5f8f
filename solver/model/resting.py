"""What touches and is at rest at an end of a phase: told twice, that it does not move.

Velocities that are all fixed at zero keep every contact at rest. A start then needs no row of the
contact; at an end, where contacts are held anyway, as many of the velocities need not be fixed.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas.expressions import Name, derivative
from solver.lowering import Form
from solver.model.model import Interval
from solver.numeric import Array, along

_NONE = 1e-9


def resting_rates(
    form: Form, initial: Mapping[str, Interval], rates: Sequence[str], statics: Sequence[str]
) -> set[str]:
    """The rates that velocities fixed at zero keep at zero."""
    if not rates:
        return set()
    velocities, matrix = _jacobian(form, rates, statics)
    moving = [not _rests(initial[name]) for name in velocities]
    reach = np.abs(matrix[:, moving]).max(axis=1, initial=0.0)
    return {name for name, most in zip(rates, reach, strict=True) if most <= _NONE}


def spare_velocities(
    form: Form, final: Mapping[str, Interval], statics: Sequence[str]
) -> list[str]:
    """Velocities that come to rest by themselves where all others do, at a phase's end."""
    rates = [one.rate for one in form.holonomic]
    resting = sorted(resting_rates(form, final, rates, statics))
    if not resting:
        return []
    velocities, matrix = _jacobian(form, resting, statics)
    spare: list[str] = []
    for _ in resting:  # Gauss-Jordan, the largest pivot first
        size = np.abs(matrix)
        row, column = np.unravel_index(int(np.argmax(size)), size.shape)
        if size[row, column] <= _NONE:
            break
        spare.append(velocities[column])
        matrix = matrix - np.outer(matrix[:, column], matrix[row] / matrix[row, column])
    return spare


def _rests(limits: Interval) -> bool:
    return limits.lower == limits.upper == 0.0


def _jacobian(form: Form, rates: Sequence[str], statics: Sequence[str]) -> tuple[list[str], Array]:
    """Velocities, and the rates that each alone makes at some place, (rates, velocities)."""
    velocities = [derivative(name) for name in form.states if derivative(name) in form.states]
    count, rng = len(velocities), np.random.default_rng(0)
    x = {name: np.full(count, rng.normal()) for name in form.states}
    x |= dict(zip(velocities, np.eye(count), strict=True))
    states = np.array([x[name] for name in form.states])
    controls, given = np.zeros((len(form.controls), count)), dict.fromkeys(statics, 1.0)
    ready = along(form, [Name(name) for name in rates], given)
    return velocities, np.asarray(ready(np.zeros(count), states, controls))
