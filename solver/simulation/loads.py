"""What drives a mechanism and holds it back: springs, motors, forces and torques of the user."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import assert_never

import numpy as np

from schemas.expressions import Expression, Tree
from schemas.mechanisms import (
    Floating,
    Mechanism,
    Motor,
    Prismatic,
    Revolute,
    Welded,
    motor_control,
)
from solver.numeric.tape import Array
from solver.simulation.constants import Constants
from solver.simulation.kinematics import Complex, Kinematics, Points, Pose


@dataclass(frozen=True, slots=True)
class Axes:
    """The joints of one coordinate: their values are ``rows @ q + offsets``, (joints, n)."""

    names: tuple[str, ...]
    rows: Array
    offsets: Array

    @classmethod
    def of(cls, mechanism: Mechanism, kinematics: Kinematics, constants: Constants) -> "Axes":
        """In the order of the links."""
        names, rows, offsets = [], [], []
        number, q = kinematics.rows, kinematics.coordinates
        for link in mechanism.links:
            child, parent = number[link.body], number[link.parent]
            match link.joint:
                case Prismatic():
                    rows.append(np.eye(len(q))[list(q).index(link.coordinates[0])])
                    offsets.append(0.0)
                case Revolute():
                    rows.append(kinematics.turning[child] - kinematics.turning[parent])
                    apart = kinematics.offsets[child] - kinematics.offsets[parent]
                    absolute = link.coordinates[0] != link.joint_name
                    offsets.append(apart - constants.number(link.joint.angle) if absolute else 0.0)
                case Welded() | Floating():  # no single coordinate
                    continue
                case _:
                    assert_never(link.joint)
            names.append(link.joint_name)
        return cls(tuple(names), np.reshape(rows, (len(names), len(q))), np.array(offsets))

    def row(self, joint: str) -> Array:
        """d(joint)/dq, (n,)."""
        return np.asarray(self.rows[self.names.index(joint)])


@dataclass(frozen=True, slots=True)
class Drive:
    """A motor: from its control to the torque and power at its joint.

    The constant of a motor with losses has the gearbox in it: no gear then.
    """

    control: int
    axis: int
    gear: float
    losses: Mapping[str, float] | None

    @classmethod
    def of(cls, motor: Motor, control: int, axis: int, constants: Constants) -> "Drive":
        """Its numbers."""
        losses = None
        if motor.losses is not None:
            losses = {
                name: constants.number(getattr(motor.losses, name))
                for name in type(motor.losses).model_fields
            }
        return cls(control, axis, constants.number(motor.gear), losses)

    def torque(self, control: Array, speed: Array) -> Array:
        """At the joint, N m; with losses by 003, equation 2.1."""
        if self.losses is None:
            return np.asarray(self.gear * control)
        a = self.losses
        lost = a["coulomb"] + a["friction"] * a["constant"] * np.abs(control)
        sign = np.tanh(speed / a["smoothing"])
        return np.asarray(a["constant"] * control - a["viscous"] * speed - lost * sign)

    def power(self, control: Array, speed: Array) -> Array:
        """Mechanical, W; with losses electrical, by 003, equation 2.2."""
        if self.losses is None:
            return self.torque(control, speed) * speed
        a = self.losses
        sign = np.tanh(speed / a["smoothing"])
        volts = control * a["resistance"] + sign * a["brush"] + a["constant"] * speed
        return np.asarray(volts * control)


@dataclass(frozen=True, slots=True)
class Stretch:
    """How long springs are: z and d(z) (springs, N), and dz/dq (springs, n, N)."""

    length: Array
    rate: Array
    slope: Array


@dataclass(frozen=True, slots=True)
class Springs:
    """Along joints, or between points. ``ends`` are over the features, (springs, features)."""

    names: tuple[str, ...]
    rows: Array
    offsets: Array
    ends: tuple[Complex, Complex]
    apart: tuple[int, ...]
    pulling: tuple[int, ...]

    @classmethod
    def of(
        cls, mechanism: Mechanism, kinematics: Kinematics, axes: Axes, constants: Constants
    ) -> "Springs":
        """Read the springs."""
        count = len(mechanism.springs)
        rows, offsets = np.zeros((count, axes.rows.shape[1])), np.zeros(count)
        shape = (count, kinematics.places.shape[1])
        ends = np.zeros(shape, dtype=complex), np.zeros(shape, dtype=complex)
        springs = list(mechanism.springs.values())
        for number, spring in enumerate(springs):
            if spring.joint is not None:
                rows[number] = axes.row(spring.joint)
                offsets[number] = axes.offsets[axes.names.index(spring.joint)]
            for side, place in zip(ends, spring.between or [], strict=False):
                side[number] = kinematics.place(place, constants)
        return cls(
            tuple(mechanism.springs),
            rows,
            offsets,
            ends,
            tuple(i for i, spring in enumerate(springs) if spring.between is not None),
            tuple(i for i, spring in enumerate(springs) if spring.pulling_only),
        )

    def stretch(self, pose: Pose) -> Stretch:
        """All springs at the points in time of a pose."""
        length = self.rows @ pose.q + self.offsets[:, None]
        rate = self.rows @ pose.v
        slope = np.repeat(self.rows[..., None], pose.q.shape[1], axis=2)
        if self.apart:
            some = list(self.apart)
            both = pose.points(np.concatenate([side[some] for side in self.ends]))
            first, second = both[: len(some)], both[len(some) :]
            line = second.z - first.z
            length[some] = np.abs(line)
            toward = line.conj() / np.abs(line)
            rate[some] = (toward * (second.rate - first.rate)).real
            slope[some] = (toward[:, None] * (second.slopes - first.slopes)).real
        return Stretch(length, rate, slope)

    def forces(self, stretch: Stretch, laws: Array) -> Array:
        """Along z, (springs, N), from stiffness, rest, damping, engaged: (springs, 4, N)."""
        stiffness, rest, damping, engaged = laws.transpose(1, 0, 2)
        force = stiffness * (rest - stretch.length) - damping * stretch.rate
        some = list(self.pulling)
        force[some] = np.minimum(force[some], 0.0)
        return np.asarray(engaged * force)

    def energy(self, stretch: Stretch, laws: Array) -> Array:
        """Stored, J, (N,)."""
        stiffness, rest, _, engaged = laws.transpose(1, 0, 2)
        beyond = stretch.length - rest
        some = list(self.pulling)
        beyond[some] = np.maximum(beyond[some], 0.0)
        return np.asarray(np.sum(engaged * stiffness * beyond**2 / 2, axis=0))


@dataclass(frozen=True, slots=True)
class Pushes:
    """Forces and torques of the user: each along a place's slope, or a row of the coordinates.

    ``places`` (forces, features), ``directions`` complex, turned with ``bodies`` (0: the world);
    ``rows`` (torques, n).
    """

    places: Complex
    directions: Complex
    bodies: tuple[int, ...]
    rows: Array

    @classmethod
    def of(
        cls, mechanism: Mechanism, kinematics: Kinematics, axes: Axes, constants: Constants
    ) -> "Pushes":
        """Read forces and torques."""
        places, directions, bodies, rows = [], [], [], []
        for force in mechanism.forces.values():
            body = kinematics.rows[force.body]
            places.append(kinematics.fixed(body, constants.vector(force.at)))
            directions.append(constants.unit(force.direction))
            bodies.append(body if force.frame == "body" else 0)
        for torque in mechanism.torques.values():
            row = (
                kinematics.turning[kinematics.rows[torque.body]]
                if torque.body is not None
                else axes.row(torque.joint or "")
            )
            rows.append(row)
        width = kinematics.places.shape[1]
        return cls(
            np.reshape(np.array(places, dtype=complex), (len(places), width)),
            np.array(directions, dtype=complex),
            tuple(bodies),
            np.reshape(rows, (len(rows), axes.rows.shape[1])),
        )

    def generalized(self, pose: Pose, forces: Array, torques: Array) -> Array:
        """(n, N), from the sizes of forces (forces, N) and torques (torques, N)."""
        total = self.rows.T @ torques
        if self.bodies:
            points: Points = pose.points(self.places)
            toward = self.directions[:, None] * pose.turns[list(self.bodies)]
            along = (toward.conj()[:, None] * points.slopes).real
            total = total + np.einsum("fnN,fN->nN", along, forces)
        return np.asarray(total)


def laws_of(mechanism: Mechanism) -> list[Tree]:
    """What the user wrote of springs (four each), forces and torques, in this order."""
    found: list[Expression] = []
    for spring in mechanism.springs.values():
        found += [spring.stiffness, spring.rest, spring.damping, spring.engaged]
    found += [force.value for force in mechanism.forces.values()]
    found += [torque.value for torque in mechanism.torques.values()]
    return [one.tree for one in found]


def drives_of(mechanism: Mechanism, axes: Axes, constants: Constants) -> dict[str, Drive]:
    """The motors by name."""
    controls = mechanism.control_names
    return {
        name: Drive.of(
            motor,
            controls.index(motor_control(name, motor)),
            axes.names.index(motor.joint),
            constants,
        )
        for name, motor in mechanism.motors.items()
    }
