"""Any kind of system as something that moves: rates of states, and expressions over its names."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel, Issue
from schemas.expressions import Name, Tree, derivative
from schemas.mechanisms import Mechanism
from schemas.systems import Ode, SecondOrder, System
from schemas.urdf import Urdf
from solver.numeric.tape import Array, Tape
from solver.numeric.unknowns import Solve
from solver.simulation.evaluator import Evaluator
from solver.simulation.multibody import Multibody
from solver.simulation.scope import Vocabulary
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_plant import SpatialPlant

Evaluate = Callable[[Array, Array, Array], Array]
"""Times (N,), states (states, N), controls (controls, N) -> one row for each expression."""


class Plant(Protocol):
    """A system of known numbers."""

    @property
    def states(self) -> Sequence[str]:
        """Names of x."""

    @property
    def controls(self) -> Sequence[str]:
        """Names of u."""

    def rates(self, t: Array, x: Array, u: Array) -> Array:
        """dx/dt (states, N) at times (N,), states (states, N) and controls (controls, N)."""

    def evaluator(self, trees: Sequence[Tree]) -> Evaluate:
        """Expressions over the system's names. Raises InvalidModel for names without value."""


def plant_of(system: System, statics: Mapping[str, float]) -> Plant:
    """A system ready to move.

    Raises
    ------
    InvalidModel
        Where a force or rate depends on what is not known before it.
    """
    if isinstance(system, Mechanism):
        return MechanismPlant(Multibody.of(system, statics))
    if isinstance(system, Urdf):
        return SpatialPlant(SpatialMultibody.of(system, statics))
    if isinstance(system, Ode | SecondOrder):
        return EquationPlant.of(system, statics)
    raise InvalidModel([Issue("/system/kind", f"a '{system.kind}' is not simulated")])


@dataclass(frozen=True, slots=True)
class EquationPlant:
    """An ``ode`` or ``second_order`` system. Implicit accelerations are solved for, pointwise.

    ``solve`` fills the last inputs of every tape, from ``first`` on.
    """

    states: tuple[str, ...]
    controls: tuple[str, ...]
    words: Vocabulary
    inputs: tuple[str, ...]
    tape: Tape
    first: int
    solve: Solve | None = None

    @classmethod
    def of(cls, system: Ode | SecondOrder, statics: Mapping[str, float]) -> "EquationPlant":
        """Read the equations."""
        constants = {**statics, **resolve.parameters(system)}
        states, controls = tuple(system.state_names), tuple(system.control_names)
        definitions = {name: one.tree for name, one in system.define.items()}
        unknown: list[str] = []
        if isinstance(system, Ode):
            definitions |= {derivative(name): one.tree for name, one in system.derivatives.items()}
        elif system.accelerations is not None:
            given = system.accelerations.items()
            definitions |= {derivative(name, 2): one.tree for name, one in given}
        else:
            unknown = [derivative(name, 2) for name in system.coordinates]
        inputs = ("t", *states, *controls, *unknown)
        words = Vocabulary(constants, definitions, frozenset(inputs).__contains__)
        tape, _ = words.record([Name(derivative(name)) for name in states], inputs)
        first = len(inputs) - len(unknown)
        solve = None
        if unknown and isinstance(system, SecondOrder):
            rows = [one.tree for one in system.residual or []]
            solve = Solve(words.record(rows, inputs)[0], first)
        return cls(states, controls, words, inputs, tape, first, solve)

    def rates(self, t: Array, x: Array, u: Array) -> Array:
        """dx/dt."""
        return self._evaluated(self.tape, t, x, u)

    def evaluator(self, trees: Sequence[Tree]) -> Evaluate:
        """Expressions over states, controls, intermediates and their derivatives."""
        tape, _ = self.words.record(trees, self.inputs)
        return lambda t, x, u: self._evaluated(tape, t, x, u)

    def _evaluated(self, tape: Tape, t: Array, x: Array, u: Array) -> Array:
        inputs = [t, *x, *u, *[np.nan] * (len(self.inputs) - self.first)]
        if self.solve is not None and not tape.reads.isdisjoint(
            range(self.first, len(self.inputs))
        ):
            inputs[self.first :] = self.solve(inputs, np.shape(t))
        return tape(inputs, np.shape(t))


@dataclass(frozen=True, slots=True)
class MechanismPlant:
    """A mechanism, its own ``mode`` and its loops held."""

    model: Multibody

    @property
    def states(self) -> Sequence[str]:
        """Coordinates, then velocities."""
        return self.model.mechanism.state_names

    @property
    def controls(self) -> Sequence[str]:
        """The motors' and the user's."""
        return self.model.controls

    def rates(self, t: Array, x: Array, u: Array) -> Array:
        """Velocities, then accelerations."""
        n = len(x) // 2
        held = self.model.accelerations(t, x[:n], x[n:], u)
        return np.concatenate([x[n:], held.accelerations])

    def evaluator(self, trees: Sequence[Tree]) -> Evaluate:
        """Expressions over everything that the mechanism names, forces of its mode too."""
        found = Evaluator.of(self.model, trees)

        def evaluate(t: Array, x: Array, u: Array) -> Array:
            n = len(x) // 2
            return found(t, x[:n], x[n:], u)

        return evaluate
