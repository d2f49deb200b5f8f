"""The motion of a URDF system as equations: inverse dynamics over names, one residual a coordinate.

Recursive Newton-Euler over trees: forward in `spatial_motion`, backward here. Nothing is solved,
and there is no mass matrix.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from schemas.expressions import Name, Number, Tree, derivative
from schemas.urdf import WORLD, Urdf, motor_torque
from solver.mechanics.spatial_bodies import Body
from solver.mechanics.spatial_contacts import (
    SpatialHeld,
    held_contacts,
    spatial_touches,
    touching_loads,
)
from solver.mechanics.spatial_dependence import dependent
from solver.mechanics.spatial_motion import Motions, moments
from solver.mechanics.spatial_series import series
from solver.mechanics.spatial_turns import norm_rows
from solver.mechanics.spatial_vectors import (
    NOWHERE,
    Mat3,
    Vec3,
    applied,
    constant,
    cross,
    dot,
    scaled,
    total,
    turned,
    written,
)
from solver.mechanics.trees import less, minus, plus, times


@dataclass(frozen=True, slots=True)
class SpatialEquations:
    """What the links say about its motion; as `solver.mechanics.Equations` of a mechanism.

    Attributes
    ----------
    trees
        Definitions of every name of ``system.defined``, of shared pieces under names with a
        ``#``, and of the rows.
    rows
        Names of the residuals: one a coordinate, then what holds the contacts that touch.
    forces
        Names of forces that are found together with the accelerations, one a held contact.
    held
        What is held along the phase: contacts that touch, norms of quaternions.
    dependent
        Labels of held contacts that others hold already: their forces could be anything.
    """

    trees: dict[str, Tree]
    rows: tuple[str, ...]
    forces: tuple[str, ...]
    held: tuple[SpatialHeld, ...]
    dependent: tuple[str, ...] = ()


def spatial_equations(system: Urdf) -> SpatialEquations:
    """The equations of motion of a checked system."""
    motions = Motions.of(system)
    touches = spatial_touches(motions)
    balance = _Balance(motions)
    for body in motions.bodies.bodies.values():
        balance.inertial(body)
    for body_name, at, force in (*_loads(motions), *touching_loads(motions, touches)):
        balance.load(body_name, at, force)
    rows = {f"#dynamics {name}": tree for name, tree in balance.generalized().items()}
    contacts = held_contacts(motions, touches)
    rows |= {f"#held {one.label}": Name(one.acceleration) for one in contacts}
    trees = series(motions, touches) | motions.trees | rows
    forces = tuple(one.force for one in contacts)
    more = dependent(system.coordinates, contacts, trees) if contacts else ()
    return SpatialEquations(trees, tuple(rows), forces, (*contacts, *_norms(system)), more)


def _norms(system: Urdf) -> Iterator[SpatialHeld]:
    for first in system.balls:
        prefix = first.rpartition(".")[0]
        held = f"{prefix}#norm"
        yield SpatialHeld(f"{prefix}.norm", "", held, derivative(held), derivative(held, 2))


def _loads(motions: Motions) -> Iterator[tuple[str, Vec3, Vec3]]:
    """The user's forces: body, place and force in the body's axes."""
    for one in motions.system.forces.values():
        host = motions.bodies.hosts[one.link]
        body, pose = host
        along = scaled(one.value.tree, written(one.direction))
        force = turned(pose.axes, along) if one.frame == "link" else motions.local(body, along)
        yield body, motions.place(host, written(one.at)), force


@dataclass(slots=True)
class _Balance:
    """Forces and torques that each joint carries, from the tips to the base."""

    motions: Motions
    _forces: dict[str, list[Vec3]] = field(default_factory=lambda: defaultdict(list))
    _torques: dict[str, list[Vec3]] = field(default_factory=lambda: defaultdict(list))

    def inertial(self, body: Body) -> None:
        """What it takes to accelerate a body against gravity."""
        if not body.mass and not any(any(row) for row in body.inertia):
            return
        spread, push = self.motions.fields[body.name], self.motions.pushes[body.name]
        moment = constant(body.moment)
        force = total(scaled(Number(body.mass), push), applied(spread, moment))
        self._forces[body.name].append(force)
        self._torques[body.name].append(total(cross(moment, push), _turning(spread, moments(body))))

    def load(self, body: str, at: Vec3, force: Vec3) -> None:
        """A force that acts on a body, so the joint need not give it."""
        if body != WORLD:
            against = scaled(Number(-1.0), force)
            self._forces[body].append(against)
            self._torques[body].append(cross(at, against))

    def generalized(self) -> dict[str, Tree]:
        """Along every coordinate, what is missing: zero along the motion."""
        found: dict[str, list[Tree]] = {name: [] for name in self.motions.system.coordinates}
        for body in reversed(self.motions.bodies.bodies.values()):
            force, torque = self._carried(body)
            step = body.step
            if step.kind == "ball":
                held = norm_rows(step.coordinates[0].rpartition(".")[0], step)
                self.motions.trees |= held
                rows = (Name(list(held)[-1]), *torque)
                for name, row in zip(step.coordinates, rows, strict=True):
                    found[name].append(row)
            else:
                along = dot(constant(step.axis), torque if step.kind == "hinge" else force)
                found[step.coordinates[0]].append(times(Number(step.factor), along))
                found[step.coordinates[0]].append(_damped(body))
        for name in self.motions.system.motor_joints:
            found[name].append(minus(Name(motor_torque(name))))
        for name, terms in found.items():  # stops that push (``solver.contact``)
            if (stop := f"limit.{name}") in self.motions.system.define:
                terms.append(minus(Name(stop)))
        return {name: plus(*terms) for name, terms in found.items()}

    def _carried(self, body: Body) -> tuple[Vec3, Vec3]:
        """Force and torque through a body's step, in its axes; the parent gets its share."""
        motions, name = self.motions, body.name
        force = motions.shared(f"{name}#f", total(NOWHERE, *self._forces[name]))
        torque = motions.shared(f"{name}#n", total(NOWHERE, *self._torques[name]))
        if body.parent != WORLD:
            passed = motions.shared(f"{name}#g", motions.out(body, force))
            turning = total(motions.out(body, torque), cross(motions.lever(body), passed))
            self._forces[body.parent].append(passed)
            self._torques[body.parent].append(turning)
        return force, torque


def _turning(spread: Mat3, spreads: Mat3) -> Vec3:
    """The sum of ``x cross B x`` over the mass: of B S what is not symmetric."""
    product = [applied(spreads, row) for row in spread]  # S is symmetric
    return (
        less(product[2][1], product[1][2]),
        less(product[0][2], product[2][0]),
        less(product[1][0], product[0][1]),
    )


def _damped(body: Body) -> Tree:
    """A joint's damping acts on its own rate, be it a follower's."""
    rate = times(Number(body.step.factor), Name(derivative(body.step.coordinates[0])))
    return times(Number(body.damping * body.step.factor), rate)
