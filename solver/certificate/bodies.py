"""A mechanism's rates as the judge has them: from its bodies, not from the solver's mechanics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from schemas.errors import InvalidModel
from schemas.expressions import ExpressionError, Tree, derivative
from schemas.mechanisms import Mechanism
from schemas.urdf import Urdf
from solver.lowering.form import Form
from solver.numeric import Array
from solver.simulation.evaluator import Evaluator
from solver.simulation.multibody import Multibody
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_plant import SpatialPlant

Evaluate = Callable[[Array | float, Array, Array], Array]
"""Times (...), states (n_x, ...), controls (n_u, ...) -> values (expressions, ...)."""

Others = Callable[[Sequence[Tree]], Evaluate]

Model = Multibody | SpatialMultibody


@dataclass(frozen=True, slots=True)
class Rows:
    """Where everything is among states and controls, one below the other.

    Attributes
    ----------
    q, v, u
        Coordinates, velocities, and the controls that the model takes; -1: it is nowhere, zero.
    rates
        The rates of the states among: velocities, accelerations, states and controls.
    """

    q: list[int]
    v: list[int]
    u: list[int]
    rates: list[int]

    @classmethod
    def of(cls, form: Form, model: "Model") -> "Rows":
        """Find them by their names."""
        names = [*form.states, *form.controls]
        places = {name: row for row, name in enumerate(names)}
        own = model.coordinates
        speeds = [derivative(name) for name in own]
        known = {name: row for row, name in enumerate([*own, *speeds])}
        return cls(
            [places[name] for name in own],
            [places[name] for name in speeds],
            [places.get(name, -1) for name in model.controls],
            [
                known[name] if name in known else 2 * len(own) + places[derivative(name)]
                for name in form.states
            ],
        )

    def read(self, x: Array, u: Array) -> "Motion":
        """What states (n_x, ...) and controls (n_u, ...) are to the model."""
        nothing = np.zeros((1, *x.shape[1:]))
        values = np.concatenate([x, np.reshape(u, (-1, *x.shape[1:])), nothing])
        return Motion(values[self.q], values[self.v], values[self.u], values)


class Motion(NamedTuple):
    """Coordinates, velocities and controls; and all of them as they came."""

    q: Array
    v: Array
    u: Array
    values: Array


@dataclass(frozen=True, slots=True)
class Bodies:
    """The time derivatives of a form's states, by the bodies of its mechanism.

    A control whose derivatives are used is a state of the form; ``model`` takes these derivatives
    after its own controls.
    """

    model: Model
    rows: Rows

    @classmethod
    def of(
        cls, form: Form, mechanism: Mechanism | Urdf, statics: Mapping[str, float]
    ) -> "Bodies | None":
        """None where a force depends on accelerations or contact forces: trees judge these."""
        own = {*mechanism.state_names, *mechanism.control_names}
        more = [name for name in (*form.states, *form.controls) if name not in own]
        try:
            model = _model(mechanism, statics, more)
        except (InvalidModel, ExpressionError):
            return None
        return cls(model, Rows.of(form, model))

    def __call__(self, t: Array | float, x: Array, u: Array) -> Array:
        """Rates (n_x, ...) at times (...), states (n_x, ...) and controls (n_u, ...)."""
        at = self.rows.read(x, u)
        try:
            held = self.model.accelerations(t, at.q, at.v, at.u)
        except np.linalg.LinAlgError:  # bodies without inertia that move freely
            return np.full(np.shape(x), np.nan)
        every = np.concatenate([at.v, held.accelerations, at.values])
        return np.asarray(every[self.rows.rates])

    def expressions(self, trees: Sequence[Tree], others: Others) -> Evaluate:
        """Expressions over what the mechanism names, by its bodies.

        Those that its bodies have no value for, such as higher derivatives, are left to
        ``others``, which makes the values of trees from the form.
        """
        own = [row for row, tree in enumerate(trees) if self._knows(tree)]
        if not own:
            return others(trees)
        rest = [row for row in range(len(trees)) if row not in set(own)]
        by_bodies = self._evaluator([trees[row] for row in own])
        by_form = others([trees[row] for row in rest])

        def evaluate(t: Array | float, x: Array, u: Array) -> Array:
            found = np.empty((len(trees), *np.shape(t)))
            found[own] = by_bodies(np.asarray(t), self.rows.read(x, u))
            if rest:
                found[rest] = by_form(t, x, u)
            return found

        return evaluate

    def motion(self, x: Array, u: Array) -> Motion:
        """What states (n_x, ...) and controls (n_u, ...) are to the model."""
        return self.rows.read(x, u)

    def _knows(self, tree: Tree) -> bool:
        try:
            self._evaluator([tree])
        except InvalidModel:
            return False
        return True

    def _evaluator(self, trees: Sequence[Tree]) -> Callable[[Array, Motion], Array]:
        if isinstance(self.model, Multibody):
            planar = Evaluator.of(self.model, trees)
            return lambda t, at: planar(t, at.q, at.v, at.u)
        spatial = SpatialPlant(self.model).evaluator(trees)
        return lambda t, at: spatial(t, np.concatenate([at.q, at.v]), at.u)


def _model(mechanism: Mechanism | Urdf, statics: Mapping[str, float], more: Sequence[str]) -> Model:
    if isinstance(mechanism, Urdf):
        return SpatialMultibody.of(mechanism, statics, more)
    return Multibody.of(mechanism, statics, more)
