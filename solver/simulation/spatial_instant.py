"""Links at N points in time: everything that follows from coordinates and velocities.

Computed when it is first asked for.
"""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from schemas.expressions import Expression, constant
from schemas.urdf import Link, Urdf
from solver.numeric.tape import Array, Tape
from solver.simulation.spatial_kinematics import Frame, State, crossed, crossing, frames
from solver.simulation.spatial_looks import Look


@dataclass(frozen=True, slots=True)
class Numbers:
    """Constants of a URDF system: gravity (3,), places of contacts and forces, the ground."""

    gravity: Array
    centres: Mapping[str, Array]
    radii: Mapping[str, float]
    height: float
    places: Mapping[str, Array]
    directions: Mapping[str, Array]

    @classmethod
    def of(cls, system: Urdf, known: Mapping[str, float]) -> "Numbers":
        """Evaluate them. Raises ExpressionError where that cannot be done."""

        def vector(entries: Sequence[Expression]) -> Array:
            return np.array([constant(entry.tree, known) for entry in entries])

        contacts, pushes = system.contacts.items(), system.forces.items()
        return cls(
            vector(system.gravity),
            {name: vector(one.at) for name, one in contacts},
            {name: constant(one.radius.tree, known) for name, one in contacts},
            constant(system.ground.height.tree, known),
            {name: vector(one.at) for name, one in pushes},
            {name: vector(one.direction) for name, one in pushes},
        )


@dataclass(frozen=True, slots=True)
class SpatialParts:
    """What does not change.

    ``laws`` are the users' forces over ``law_inputs``; ``looks`` how to get the value of a name.
    """

    system: Urdf
    numbers: Numbers
    more: tuple[str, ...] = ()
    laws: Tape = field(default_factory=lambda: Tape((), (), ()))
    law_inputs: tuple[str, ...] = ()
    looks: Mapping[str, Look] = field(default_factory=dict)

    @property
    def controls(self) -> list[str]:
        """Names of u."""
        return [*self.system.control_names, *self.more]

    @property
    def moving(self) -> list[Link]:
        """The links that are not welded to the world."""
        names: dict[str, None] = {}
        for one in self.system.carriages:
            if one.steps or one.parent in names:
                names[one.link] = None
        return [self.system.tree.links[name] for name in names]


@dataclass(frozen=True)
class SpatialInstant:
    """Links at N points in time. Not slotted: what several ask for is cached."""

    parts: SpatialParts
    t: Array
    q: Array
    v: Array
    u: Array

    @property
    def system(self) -> Urdf:
        """What is moving."""
        return self.parts.system

    @property
    def controls(self) -> list[str]:
        """Names of u."""
        return self.parts.controls

    @property
    def mass_total(self) -> float:
        """Mass of all links that move, kg."""
        return sum(link.mass for link in self.parts.moving)

    @functools.cached_property
    def frames(self) -> dict[str, Frame]:
        """The frame of every link."""
        rows = {name: row for row, name in enumerate(self.system.coordinates)}
        return frames(self.system.carriages, State(rows, self.q, self.v))

    @functools.cached_property
    def _massive(self) -> list[tuple[float, Array, Frame]]:
        """Mass, inertia in the world's axes (N, 3, 3), and the frame at the centre of mass."""
        found = []
        for link in self.parts.moving:
            if link.mass or any(any(row) for row in link.inertia):
                frame = self.frames[link.name].shifted(np.array(link.com))
                inertia = frame.axes @ np.array(link.inertia) @ np.swapaxes(frame.axes, 1, 2)
                found.append((link.mass, inertia, frame))
        return found

    @functools.cached_property
    def mass(self) -> Array:
        """The mass matrix, (N, n, n)."""
        total = np.zeros((len(self.t), len(self.q), len(self.q)))
        for mass, inertia, frame in self._massive:
            total += mass * np.swapaxes(frame.moves, 1, 2) @ frame.moves
            total += np.swapaxes(frame.turns, 1, 2) @ inertia @ frame.turns
        return total

    @functools.cached_property
    def applied(self) -> Array:
        """Generalized forces but those of contacts, minus bias: (N, n)."""
        total = self._driven()
        for mass, inertia, frame in self._massive:
            push = mass * (self.parts.numbers.gravity - frame.bias)
            turned = np.einsum("nij,nj->ni", inertia, frame.spin)
            couple = np.einsum("nij,nj->ni", inertia, frame.turning) + crossed(frame.spin, turned)
            total += np.einsum("nik,ni->nk", frame.moves, push)
            total -= np.einsum("nik,ni->nk", frame.turns, couple)
        values = self._laws()
        for row, (name, force) in enumerate(self.system.forces.items()):
            frame = self.frames[force.link].shifted(self.parts.numbers.places[name])
            along = np.broadcast_to(self.parts.numbers.directions[name], frame.place.shape)
            if force.frame == "link":
                along = np.einsum("nij,nj->ni", frame.axes, along)
            total += np.einsum("nik,ni->nk", frame.moves, along * values[row][:, None])
        return total

    def _driven(self) -> Array:
        """Motors, and the damping of joints."""
        system, total = self.system, np.zeros_like(self.q)
        rows = {name: row for row, name in enumerate(system.coordinates)}
        for row, joint in enumerate(system.motor_joints):
            total[rows[joint]] += self.u[row]
        for one in system.carriages:
            for step in one.steps if one.damping else ():
                row = rows[step.coordinates[0]]
                total[row] -= one.damping * step.factor**2 * self.v[row]
        return total.T.copy()

    @property
    def pushing(self) -> Array:
        """The values of the user's forces, N, (forces, N)."""
        return self._laws()

    def _laws(self) -> Array:
        if not self.parts.law_inputs:
            return self.parts.laws((), np.shape(self.t))
        known = self.parts.looks
        inputs = [known[name](self) for name in self.parts.law_inputs]
        return self.parts.laws(inputs, np.shape(self.t))

    @functools.cached_property
    def centres(self) -> dict[str, Frame]:
        """The frames of all contacts, at their centres."""
        return {
            name: self.frames[one.link].shifted(self.parts.numbers.centres[name])
            for name, one in self.system.contacts.items()
        }

    def gap(self, name: str) -> Array:
        """Between a contact and the ground, (N,)."""
        numbers = self.parts.numbers
        height = self.centres[name].place[:, 2]
        return np.asarray(height - numbers.height - numbers.radii[name])

    def slip(self, name: str) -> Array:
        """Of the matter of a contact along the ground, x and y, (N, 2), m/s."""
        centre, radius = self.centres[name], self.parts.numbers.radii[name]
        down = np.array([[0.0, 0.0, -radius]])
        return np.asarray((centre.velocity + crossed(centre.spin, down))[:, :2])

    def rows(self, name: str) -> tuple[Array, Array]:
        """Of a contact along z, x and y: Jacobians (N, 3, n) of the point that touches, bias."""
        centre, radius = self.centres[name], self.parts.numbers.radii[name]
        down = np.array([0.0, 0.0, -radius])
        J = centre.moves - crossing(down[None]) @ centre.turns
        bias = centre.bias + crossed(centre.turning, down)
        return J[:, [2, 0, 1]], bias[:, [2, 0, 1]]

    @functools.cached_property
    def kinetic(self) -> Array:
        """J, (N,)."""
        total = np.zeros_like(self.t)
        for mass, inertia, frame in self._massive:
            total += mass / 2 * np.sum(frame.velocity**2, axis=1)
            total += np.einsum("ni,nij,nj->n", frame.spin, inertia, frame.spin) / 2
        return total

    @functools.cached_property
    def potential(self) -> Array:
        """J, (N,); zero at the world's origin."""
        return -self.mass_total * (self.com @ self.parts.numbers.gravity)

    @functools.cached_property
    def com(self) -> Array:
        """Centre of mass, (N, 3)."""
        parts = [mass * frame.place for mass, _, frame in self._massive]
        return np.asarray(np.sum(parts, axis=0) / self.mass_total)

    @functools.cached_property
    def momentum(self) -> Array:
        """N s, (N, 3)."""
        return np.asarray(np.sum([mass * one.velocity for mass, _, one in self._massive], axis=0))

    @functools.cached_property
    def angular(self) -> Array:
        """About the centre of mass, N m s, (N, 3)."""
        total = np.zeros_like(self.com)
        for mass, inertia, frame in self._massive:
            total += np.einsum("nij,nj->ni", inertia, frame.spin)
            total += mass * crossed(frame.place - self.com, frame.velocity)
        return total
