"""A URDF system as something that moves (`solver.simulation.plant`)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from schemas import resolve
from schemas.expressions import Tree, derivative
from solver.numeric.tape import Array
from solver.simulation.holding import Held
from solver.simulation.scope import Vocabulary
from solver.simulation.spatial import SpatialMultibody


@dataclass(frozen=True, slots=True)
class SpatialPlant:
    """Bodies in space; the contacts of its ``mode`` are held."""

    model: SpatialMultibody

    @property
    def states(self) -> Sequence[str]:
        """Coordinates, then velocities."""
        return self.model.system.state_names

    @property
    def controls(self) -> Sequence[str]:
        """The motors'."""
        return self.model.controls

    def rates(self, t: Array, x: Array, u: Array) -> Array:
        """Velocities, then accelerations."""
        n = len(x) // 2
        try:
            held = self.model.accelerations(t, x[:n], x[n:], u)
        except np.linalg.LinAlgError:  # links without inertia that move freely
            return np.concatenate([x[n:], np.full_like(x[n:], np.nan)])
        return np.concatenate([x[n:], held.accelerations])

    def evaluator(
        self, trees: Sequence[Tree], given: Held | None = None
    ) -> Callable[[Array, Array, Array], Array]:
        """Expressions over everything that the system names, accelerations and forces too.

        These two are the model's own, or ``given``.
        Raises InvalidModel for names without a value here.
        """
        system, model = self.model.system, self.model
        known = {**model.statics, **resolve.parameters(system)}
        definitions = {name: one.tree for name, one in system.define.items()}
        early = model.parts.looks
        accelerations = [derivative(name, 2) for name in model.coordinates]
        forces = [name for name in system.defined if name.startswith("contact.")]
        late = {*accelerations, *forces} - set(early)
        words = Vocabulary(known, definitions, {*early, *late}.__contains__)
        tape, taken = words.record(trees)

        def evaluate(t: Array, x: Array, u: Array) -> Array:
            q, v = np.split(x, 2)
            at = model.at(t, q, v, u)
            values = {name: early[name](at) for name in taken if name in early}
            if late.intersection(taken):
                held = given or model.accelerations(t, q, v, u)
                values |= dict.fromkeys(forces, np.zeros(len(t))) | dict(held.forces)
                values |= dict(zip(accelerations, held.accelerations, strict=True))
            return tape([values[name] for name in taken], np.shape(t))

        return evaluate
