"""A mechanism's names put to numbers, over its coordinates, velocities and accelerations."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from schemas import resolve
from schemas.expressions import Name, Tree, derivative
from schemas.mechanisms import Mechanism
from solver.lowering.derivations import Derivations
from solver.mechanics import Equations, equations_of
from solver.numeric.tape import Array, Scope, Tape, record


class Tapes:
    """A mechanism with its constants; controls and forces are zero, and so is the time."""

    def __init__(self, system: Mechanism, statics: Mapping[str, float]) -> None:
        self.system = system
        self.equations: Equations = equations_of(system)
        self.constants = {**resolve.parameters(system), **statics}
        accelerations = (derivative(name, 2) for name in system.coordinates)
        self._inputs = [*system.state_names, *accelerations]
        idle = ["t", *system.control_names, *self.equations.forces]
        self._numbers = {**self.constants, **dict.fromkeys(idle, 0.0)}
        trees: dict[str, Tree] = {name: one.tree for name, one in system.define.items()}
        known = {*self._inputs, *idle}
        self._derivations = Derivations(
            trees | self.equations.trees, self.constants, (), known.__contains__
        )

    def tape(self, names: Sequence[str]) -> Tape:
        """Names over coordinates, velocities and accelerations."""
        self._derivations.demand(names)
        definitions = self._derivations.definitions(names)
        scope = Scope(self._inputs, self._numbers, definitions)
        return record([Name(name) for name in names], scope)

    def at(self, tape: Tape, poses: Array, order: int = 0, rates: Array | None = None) -> Array:
        """Values (names, k) at poses (n, k), with ``rates`` (n, k) as derivatives of an order."""
        rest = np.zeros_like(poses)
        parts = [poses, rest, rest]
        if rates is not None:
            parts[order] = rates
        return tape([row for part in parts for row in part], poses.shape[1:])

    @cached_property
    def _dynamics(self) -> Tape:
        return self.tape(self.equations.rows[: len(self.system.coordinates)])

    def masses(self, poses: Array) -> Array:
        """Mass matrices at some poses (poses, n), (poses, n, n): rows at unit accelerations."""
        count = poses.shape[1]
        unit = np.hstack([np.zeros((count, 1)), np.eye(count)])
        same = (np.repeat(pose[:, None], count + 1, axis=1) for pose in poses)
        values = [self.at(self._dynamics, pose, 2, unit) for pose in same]
        return np.array([one[:, 1:] - one[:, :1] for one in values])

    def rows(self, rates: Tape, pose: Array) -> Array:
        """Directions at a pose (n,), (names, n): rates at unit velocities."""
        count = len(pose)
        return self.at(rates, np.repeat(pose[:, None], count, axis=1), 1, np.eye(count))
