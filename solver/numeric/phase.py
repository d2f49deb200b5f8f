"""Expressions of a phase, evaluated along it and at its ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas import resolve
from schemas.expressions import Tree
from schemas.systems import System
from solver.numeric.tape import Array, Scope, Tape, record


@dataclass(frozen=True, slots=True)
class Along:
    """Expressions over time, states and controls; a rate per state where made by ``dynamics``."""

    tape: Tape

    def __call__(self, t: Array | float, x: Array, u: Array) -> Array:
        """Values (expressions, ...) at times (...), states (n_x, ...) and controls (n_u, ...)."""
        return self.tape([t, *x, *u], np.shape(t))


def along(system: System, trees: Sequence[Tree]) -> Along:
    """Make expressions over a system's names ready; parameters are folded in."""
    scope = Scope(
        inputs=["t", *system.states, *system.controls],
        constants=resolve.parameters(system),
        definitions={name: expression.tree for name, expression in system.define.items()},
    )
    return Along(record(trees, scope))


def dynamics(system: System) -> Along:
    """The time derivatives of the states, in the states' order."""
    return along(system, [system.derivatives[name].tree for name in system.states])


def evaluate(tree: Tree, values: Mapping[str, float]) -> float:
    """One expression over named numbers, such as an objective; NaN where it has no value."""
    return float(record([tree], Scope((), values))((), ())[0])
