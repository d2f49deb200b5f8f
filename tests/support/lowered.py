"""A mechanism's equations put to numbers: any name, and the residuals, at states and forces."""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas import resolve
from schemas.expressions import Name, derivative
from schemas.mechanisms import Mechanism
from solver.lowering.derivations import Derivations
from solver.mechanics import equations_of
from solver.numeric.tape import Array, Scope, Tape, record


class Lowered:
    """Names of a mechanism over time, coordinates, velocities, accelerations, controls, forces."""

    def __init__(self, mechanism: Mechanism, statics: Mapping[str, float] | None = None) -> None:
        self.mechanism = mechanism
        self.equations = equations_of(mechanism)
        self.constants = {**resolve.parameters(mechanism), **(statics or {})}
        q = mechanism.coordinates
        accelerations = [derivative(name, 2) for name in q]
        self.inputs = [
            *("t", *mechanism.state_names),
            *(*accelerations, *mechanism.control_names, *self.equations.forces),
            *(derivative(name) for name in mechanism.control_names),
        ]

    def __call__(self, names: Sequence[str], values: Mapping[str, Array]) -> Array:
        """Values (names, N); inputs that are not given are zero."""
        shape = np.shape(next(iter(values.values())))
        inputs = [values.get(name, np.zeros(shape)) for name in self.inputs]
        return self.tape(names)(inputs, shape)

    def tape(self, names: Sequence[str]) -> Tape:
        """Names over all inputs."""
        trees = {name: one.tree for name, one in self.mechanism.define.items()}
        known = {*self.inputs, *self.constants}.__contains__
        derivations = Derivations(trees | self.equations.trees, self.constants, (), known)
        derivations.demand(names)
        scope = Scope(self.inputs, self.constants, derivations.definitions(names))
        return record([Name(name) for name in names], scope)

    def random(self, count: int = 6, seed: int = 0) -> dict[str, Array]:
        """Values of every input."""
        rng = np.random.default_rng(seed)
        return {name: rng.normal(size=count) for name in self.inputs}

    def stacked(self, values: Mapping[str, Array], order: int = 0) -> Array:
        """Coordinates or their derivatives, (n, N)."""
        return np.array([values[derivative(one, order)] for one in self.mechanism.coordinates])
