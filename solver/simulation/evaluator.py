"""Expressions over a mechanism's names, forces and accelerations among them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.expressions import Tree, derivative
from solver.numeric.tape import Array, Tape
from solver.simulation.constants import Constants
from solver.simulation.holding import Held
from solver.simulation.instant import Instant
from solver.simulation.kinematics import Complex
from solver.simulation.multibody import Multibody
from solver.simulation.scope import Vocabulary

Late = Callable[[Instant, Held], Array]
"""Gets the values of a name, (N,), once forces and accelerations are known."""

_OF_PLACES = {"dd(x)": 0, "d(vx)": 0, "dd(y)": 1, "d(vy)": 1}
_OF_ANGLES = ("dd(angle)", "d(omega)")


@dataclass(frozen=True, slots=True)
class Evaluator:
    """Some expressions, ready for coordinates, velocities and controls."""

    model: Multibody
    tape: Tape
    names: tuple[str, ...]
    late: Mapping[str, Late]

    @classmethod
    def of(cls, model: Multibody, trees: Sequence[Tree]) -> "Evaluator":
        """Make expressions ready. Raises InvalidModel for names without a value here."""
        mechanism = model.mechanism
        late = late_names(model)
        known = Constants.of(mechanism, model.statics).values
        definitions = {name: one.tree for name, one in mechanism.define.items()}
        supplied = {*model.parts.looks, *late}
        tape, names = Vocabulary(known, definitions, supplied.__contains__).record(trees)
        return cls(model, tape, names, {name: late[name] for name in names if name in late})

    def __call__(self, t: Array, q: Array, v: Array, u: Array) -> Array:
        """Values (expressions, N) at times (N,); the other arguments are (names, N)."""
        at = self.model.at(t, q, v, u)
        inputs = []
        if self.late:
            held = self.model.accelerations(at.t, at.q, at.v, at.u)
        for name in self.names:
            late = self.late.get(name)
            inputs.append(late(at, held) if late else self.model.parts.looks[name](at))
        return self.tape(inputs, at.t.shape)


def late_names(model: Multibody) -> dict[str, Late]:
    """Forces of contacts and loops, zero where open; accelerations of everything."""
    mechanism, found = model.mechanism, dict[str, Late]()
    for owner, words in (
        *((f"contact.{name}", ("normal", "tangential")) for name in mechanism.touching),
        *((f"loop.{name}", ("x", "y")) for name in mechanism.loops),
    ):
        found |= {f"{owner}.{word}": _force(f"{owner}.{word}") for word in words}
    masses = model.parts.masses
    centre = masses @ model.parts.coms / masses.sum()
    for name, place in {**model.parts.spots, "com": centre}.items():
        found |= {f"{name}.{word}": _moved(place, side) for word, side in _OF_PLACES.items()}
    for row, name in enumerate(model.pairs):
        found[f"contact.{name}.dd(gap)"] = _parted(row)
        found[f"contact.{name}.d(slip)"] = _slid(row)
    kinematics = model.parts.kinematics
    for row, name in enumerate(kinematics.bodies, 1):
        found |= {f"{name}.{word}": _turned(kinematics.turning[row]) for word in _OF_ANGLES}
    axes = model.parts.axes
    for name, slope in zip(axes.names, axes.rows, strict=True):
        found[derivative(name, 2)] = _turned(slope)
    for name, slope in zip(model.coordinates, np.eye(len(model.coordinates)), strict=True):
        found[derivative(name, 2)] = _turned(slope)
    return found


def _force(name: str) -> Late:
    return lambda at, held: np.asarray(held.forces.get(name, np.zeros_like(at.t)))


def _turned(slope: Array) -> Late:
    return lambda _, held: np.asarray(slope @ held.accelerations)


def _parted(row: int) -> Late:
    def late(at: Instant, held: Held) -> Array:
        touch = at.contacts
        along = np.einsum("nN,nN->N", touch.Jn[row], held.accelerations)
        return np.asarray(along + touch.gap_bias[row])

    return late


def _slid(row: int) -> Late:
    def late(at: Instant, held: Held) -> Array:
        touch = at.contacts
        along = np.einsum("nN,nN->N", touch.Jt[row], held.accelerations)
        return np.asarray(along + touch.slip_bias[row])

    return late


def _moved(place: Complex, side: int) -> Late:
    def late(at: Instant, held: Held) -> Array:
        points = at.pose.points(place[None])
        total = np.einsum("nN,nN->N", points.slopes[0], held.accelerations) + points.bias[0]
        return np.asarray(total.imag if side else total.real)

    return late
