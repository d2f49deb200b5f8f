"""Steps of the discrete-gradient backward Euler put to numbers, and their energies by others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from schemas import resolve
from schemas.expressions import Expression, constant, derivative
from schemas.mechanisms import Mechanism
from solver.discrete import Step, step_rows
from solver.expressions import SX
from solver.mechanics.principle import principle_of
from solver.numeric.tape import Array
from tests.support.lowered import Lowered

TENDON_WIDTH = 1e-4


@dataclass(frozen=True)
class Instance:
    """Numbers of a step: coordinates at three knots, (3, n_q), two lengths, time and controls."""

    q: Array
    before: float
    h: float
    controls: Mapping[str, float]
    t: float = 0.4

    @property
    def v0(self) -> Array:
        """The chord of the step before."""
        return np.asarray((self.q[1] - self.q[0]) / self.before)

    @property
    def v1(self) -> Array:
        """The chord of the step."""
        return np.asarray((self.q[2] - self.q[1]) / self.h)


@dataclass(frozen=True)
class Books:
    """The energies of a step, J: what is gained, put in, and lost."""

    kinetic: float
    potential: float
    work: float
    contact_work: float
    damped: float
    dissipated: float


class Steps:
    """The rows of a mechanism's steps, and everything else of them by its lowered equations."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism, self.low = mechanism, Lowered(_with_values(mechanism))
        self.principle = principle_of(mechanism)
        self.controls = [*mechanism.control_names, *forces_of(mechanism)]
        count, size = len(mechanism.coordinates), len(self.controls)
        q0, v0, q1, v1 = (SX.sym(name, count) for name in ("q0", "v0", "q1", "v1"))
        (h, before, t), u = (SX.sym(name) for name in ("h", "before", "t")), SX.sym("u", size)
        known = {name: SX(value) for name, value in resolve.parameters(mechanism).items()}
        known |= {"t": t} | {name: u[i] for i, name in enumerate(self.controls)}
        rows = step_rows(self.principle, Step(q0, v0, q1, v1, h, before, known))
        inputs = [q0, v0, q1, v1, h, before, t, u]
        outputs = [rows.momentum, rows.slips, rows.dissipation]
        self.function = ca.Function("step", inputs, outputs, {"cse": True})

    def random(self, seed: int = 0, h: float = 0.3, before: float = 0.2) -> Instance:
        """A step of a radian or so, anywhere."""
        rng = np.random.default_rng(seed)
        q = rng.normal(size=(3, len(self.mechanism.coordinates)))
        controls = dict(zip(self.controls, rng.normal(size=len(self.controls)), strict=True))
        return Instance(q, before, h, controls)

    def rows(self, one: Instance) -> tuple[Array, Array, float]:
        """Momentum (n_q,), slips (n_pairs,) and dissipation."""
        controls = [one.controls.get(name, 0.0) for name in self.controls]
        where = one.q[1], one.v0, one.q[2], one.v1
        found = self.function(*where, one.h, one.before, one.t, np.array(controls))
        momentum, slips, dissipation = (np.array(part).ravel() for part in found)
        return momentum, slips, float(dissipation[0])

    def values(self, names: Sequence[str], one: Instance) -> Array:
        """Names at the three knots, (names, 3); rates are those of the step that ends there."""
        given = {name: np.full(3, value) for name, value in one.controls.items()}
        rates = np.array([one.v0, one.v0, one.v1])
        for i, name in enumerate(self.mechanism.coordinates):
            given |= {name: one.q[:, i], derivative(name): rates[:, i]}
        return self.low(names, given | {"t": np.full(3, one.t)})

    def end(self, name: str, one: Instance) -> float:
        """A name at the end of the step."""
        return float(self.values([name], one)[0, 2])

    def change(self, name: str, one: Instance) -> float:
        """By how much a name changes over the step."""
        return float(np.diff(self.values([name], one)[0])[1])

    def number(self, expression: Expression) -> float:
        """A constant of the mechanism."""
        return constant(expression.tree, self.low.constants)

    def books(self, one: Instance) -> Books:
        """Its energies, from places at the knots alone."""
        kinetic, potential, dissipated = 0.0, 0.0, 0.0
        gravity = self._vector(self.mechanism.gravity)
        for name, body in self.mechanism.bodies.items():
            if body.mass is None:
                continue
            mass = self.number(body.mass)
            inertia = 0.0 if body.inertia is None else self.number(body.inertia)
            at = np.vstack([self.place(name, body.com, one), self.values([f"{name}.angle"], one)])
            before, after = np.diff(at).T / [[one.before], [one.h]]
            sizes = np.array([mass, mass, inertia])
            kinetic += float(0.5 * sizes @ (after**2 - before**2))
            dissipated += float(0.5 * sizes @ (after - before) ** 2)
            potential -= float(mass * gravity @ (at[:2, 2] - at[:2, 1]))
        stored, damped = self._springs(one)
        work = self._drives(one) + self._held(one)
        contact_work = self._contacts(one)
        return Books(kinetic, potential + stored, work, contact_work, damped, dissipated)

    def place(self, body: str, at: Sequence[Expression], one: Instance) -> Array:
        """A place of a body at the three knots, (2, 3)."""
        *origin, angles = self.values([f"{body}.{word}" for word in ("x", "y", "angle")], one)
        return np.array([turn(angle) @ self._vector(at) for angle in angles]).T + origin

    def _vector(self, pair: Sequence[Expression]) -> Array:
        return np.array([self.number(one) for one in pair])

    def _springs(self, one: Instance) -> tuple[float, float]:
        """What springs store, and what their dampers lose."""
        stored = damped = 0.0
        for name, spring in self.mechanism.springs.items():
            k, c, rest = map(self.number, (spring.stiffness, spring.damping, spring.rest))
            engaged = self.end(f"engaged_{name}", one)
            stretch = self.values([f"spring.{name}.length"], one)[0, 1:] - rest
            rate = (stretch[1] - stretch[0]) / one.h
            force = -c * rate
            if spring.pulling_only:
                force = tendon(k, -k * stretch.mean() + force) - tendon(k, -k * stretch.mean())
                stretch = 0.5 * (stretch + np.hypot(stretch, TENDON_WIDTH))
            stored += engaged * 0.5 * k * (stretch[1] ** 2 - stretch[0] ** 2)
            damped -= engaged * force * rate * one.h
        return stored, damped

    def _drives(self, one: Instance) -> float:
        """The work of motors, torques and forces."""
        work = 0.0
        for name, motor in self.mechanism.motors.items():
            gear = 1.0 if motor.losses else self.number(motor.gear)
            work += gear * self.end(f"motor.{name}.torque", one) * self.change(motor.joint, one)
        for name, torque in self.mechanism.torques.items():
            turned = torque.joint or f"{torque.body}.angle"
            work += self.end(f"torque_{name}", one) * self.change(turned, one)
        for name, force in self.mechanism.forces.items():
            moved, along = self.place(force.body, force.at, one), self._vector(force.direction)
            angle = self.end(f"{force.body}.angle", one)
            along = along / np.hypot(*along)
            along = turn(angle) @ along if force.frame == "body" else along
            work += self.end(f"force_{name}", one) * along @ (moved[:, 2] - moved[:, 1])
        return work

    def _held(self, one: Instance) -> float:
        """The work of loops."""
        work = 0.0
        for name in self.mechanism.loops:
            for side in "xy":
                work += one.controls[f"loop.{name}.{side}"] * self.change(
                    f"loop.{name}#{side}", one
                )
        return work

    def _contacts(self, one: Instance) -> float:
        """Forces along gaps, and along what slips by the rows themselves."""
        _, slips, _ = self.rows(one)
        work = 0.0
        for pair, slip in zip(self.principle.pairs, slips, strict=True):
            rubbing = one.controls[f"contact.{pair}#right"] - one.controls[f"contact.{pair}#left"]
            work += one.controls[f"contact.{pair}.normal"] * self.change(f"contact.{pair}.gap", one)
            work += rubbing * slip * one.h
        return work


def tendon(stiffness: float, force: float) -> float:
    """A tendon's force where a spring that also pushes has ``force``."""
    size = np.hypot(force, stiffness * TENDON_WIDTH)
    return float(-((size - force) ** 2) / (4 * size))


def turn(angle: float) -> Array:
    """The rotation by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def forces_of(mechanism: Mechanism) -> list[str]:
    """The forces of contacts and loops that a step is told."""
    names = []
    for pair in mechanism.touching:
        names += [f"contact.{pair}.normal", f"contact.{pair}#right", f"contact.{pair}#left"]
    return [*names, *(f"loop.{name}.{side}" for name in mechanism.loops for side in "xy")]


def _with_values(mechanism: Mechanism) -> Mechanism:
    """The mechanism with names for what the user's forces are."""
    named = {f"force_{name}": one.value for name, one in mechanism.forces.items()}
    named |= {f"torque_{name}": one.value for name, one in mechanism.torques.items()}
    named |= {f"engaged_{name}": one.engaged for name, one in mechanism.springs.items()}
    return mechanism.model_copy(update={"define": {**mechanism.define, **named}})
