"""A mechanism at N points in time: everything that follows from coordinates and velocities.

Computed when it is first asked for. `Parts` are the constant pieces of a mechanism.
"""

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from schemas.mechanisms import Mechanism
from solver.numeric.tape import Array, Tape
from solver.simulation.constants import Constants
from solver.simulation.kinematics import Complex, Kinematics, Points, Pose
from solver.simulation.loads import Axes, Drive, Pushes, Springs, Stretch, drives_of
from solver.simulation.touch import Contacts, Touch

Look = Callable[["Instant"], Array]
"""Gets the values of a name, (N,)."""


@dataclass(frozen=True, slots=True)
class Parts:
    """What does not change.

    Attributes
    ----------
    masses, inertias
        Of the bodies, (bodies,); zero for mere frames.
    coms, spots, loops
        Centres of mass, named places, both ends of the loops: over the features.
    gravity
        m/s^2, complex.
    looks
        How to get the value of each name.
    laws, law_inputs
        The user's expressions in springs, forces and torques, and the names that they take.
    """

    kinematics: Kinematics
    axes: Axes
    touch: Touch
    springs: Springs
    pushes: Pushes
    drives: Mapping[str, Drive]
    masses: Array
    inertias: Array
    coms: Complex
    spots: Mapping[str, Complex]
    loop_names: tuple[str, ...]
    loops: tuple[Complex, Complex]
    gravity: complex
    looks: Mapping[str, Look] = field(default_factory=dict)
    laws: Tape = field(default_factory=lambda: Tape((), (), ()))
    law_inputs: tuple[str, ...] = ()

    @classmethod
    def of(cls, mechanism: Mechanism, constants: Constants) -> "Parts":
        """Read a mechanism; names and laws are added by `solver.simulation.naming.named`."""
        kinematics = Kinematics.of(mechanism, constants)
        axes = Axes.of(mechanism, kinematics, constants)
        bodies = [mechanism.bodies[name] for name in kinematics.bodies]
        coms = [
            kinematics.fixed(row, constants.vector(body.com)) for row, body in enumerate(bodies, 1)
        ]
        width = kinematics.places.shape[1]
        ends = [
            np.array(
                [
                    kinematics.place(loop.between[side], constants)
                    for loop in mechanism.loops.values()
                ],
                dtype=complex,
            ).reshape(len(mechanism.loops), width)
            for side in (0, 1)
        ]
        places = {**mechanism.contacts, **mechanism.points}
        return cls(
            kinematics=kinematics,
            axes=axes,
            touch=Touch.of(mechanism, kinematics, constants),
            springs=Springs.of(mechanism, kinematics, axes, constants),
            pushes=Pushes.of(mechanism, kinematics, axes, constants),
            drives=drives_of(mechanism, axes, constants),
            masses=np.array([constants.number(body.mass) for body in bodies]),
            inertias=np.array([constants.number(body.inertia) for body in bodies]),
            coms=np.array(coms),
            spots={
                **dict(zip(kinematics.bodies, kinematics.places[1:], strict=True)),
                **{name: kinematics.place(place, constants) for name, place in places.items()},
            },
            loop_names=tuple(mechanism.loops),
            loops=(ends[0], ends[1]),
            gravity=constants.vector(mechanism.gravity),
        )


@dataclass(frozen=True)
class Instant:
    """Coordinates, velocities (n, N), controls (controls, N) and time (N,).

    Not slotted: what is asked for more than once is kept.
    """

    parts: Parts
    t: Array
    q: Array
    v: Array
    u: Array

    @functools.cached_property
    def pose(self) -> Pose:
        """Where everything is."""
        return self.parts.kinematics.pose(self.q, self.v)

    @functools.cached_property
    def coms(self) -> Points:
        """The bodies' centres of mass."""
        return self.pose.points(self.parts.coms)

    @functools.cached_property
    def contacts(self) -> Contacts:
        """Every pair."""
        return self.parts.touch.at(self.pose, self.parts.kinematics.turning)

    @functools.cached_property
    def loops(self) -> Points:
        """From the first to the second end of every loop: zero where it is closed."""
        first, second = self.parts.loops
        return self.pose.points(second - first)

    @functools.cached_property
    def stretch(self) -> Stretch:
        """How long the springs are."""
        return self.parts.springs.stretch(self.pose)

    @functools.cached_property
    def joints(self) -> tuple[Array, Array]:
        """Values and speeds of the joints of one coordinate, (joints, N) each."""
        axes = self.parts.axes
        return axes.rows @ self.q + axes.offsets[:, None], axes.rows @ self.v

    @functools.cached_property
    def mass(self) -> Array:
        """The mass matrix, (N, n, n): sum over bodies of J' diag(m, m, I) J."""
        parts = self.parts
        slopes = self.coms.slopes * np.sqrt(parts.masses)[:, None, None]
        rows = np.concatenate([slopes.real, slopes.imag]).transpose(2, 0, 1)
        turning = parts.kinematics.turning[1:]
        spinning = turning.T @ (parts.inertias[:, None] * turning)
        return np.asarray(rows.transpose(0, 2, 1) @ rows + spinning)

    @functools.cached_property
    def inertial(self) -> Array:
        """Gravity minus the velocities' own accelerations, as generalized forces, (n, N)."""
        parts, coms = self.parts, self.coms
        pull = parts.masses[:, None] * (parts.gravity - coms.bias)
        return np.asarray(np.einsum("bnN,bN->nN", coms.slopes.conj(), pull).real)

    @functools.cached_property
    def motors(self) -> Array:
        """Torques of the motors at their joints, (motors, N)."""
        speeds = self.joints[1]
        return np.array(
            [
                one.torque(self.u[one.control], speeds[one.axis])
                for one in self.parts.drives.values()
            ]
        ).reshape(len(self.parts.drives), len(self.t))

    @functools.cached_property
    def driven(self) -> Array:
        """What the motors make of it, (n, N)."""
        rows = self.parts.axes.rows[[one.axis for one in self.parts.drives.values()]]
        return np.asarray(rows.T @ self.motors)

    @functools.cached_property
    def kinetic(self) -> Array:
        """J, (N,)."""
        parts = self.parts
        linear = parts.masses @ np.abs(self.coms.rate) ** 2
        return np.asarray((linear + parts.inertias @ self.pose.spins[1:] ** 2) / 2)

    @functools.cached_property
    def potential(self) -> Array:
        """Of gravity and springs, J, (N,)."""
        down = (np.conj(self.parts.gravity) * self.coms.z).real
        stored = self.parts.springs.energy(self.stretch, self.laws[0])
        return np.asarray(stored - self.parts.masses @ down)

    @functools.cached_property
    def momentum(self) -> Complex:
        """N s, complex, (N,)."""
        return np.asarray(self.parts.masses @ self.coms.rate)

    @functools.cached_property
    def spin(self) -> Array:
        """Angular momentum about the centre of mass, N m s, (N,)."""
        masses = self.parts.masses
        apart = self.coms.z - masses @ self.coms.z / masses.sum()
        orbit = masses @ (apart.conj() * self.coms.rate).imag
        return np.asarray(orbit + self.parts.inertias @ self.pose.spins[1:])

    @functools.cached_property
    def powers(self) -> Array:
        """Of the motors, W, (motors, N)."""
        speeds = self.joints[1]
        drives = self.parts.drives.values()
        found = [one.power(self.u[one.control], speeds[one.axis]) for one in drives]
        return np.array(found).reshape(len(drives), len(self.t))

    @functools.cached_property
    def laws(self) -> tuple[Array, Array, Array]:
        """Of springs (springs, 4, N); sizes of forces (forces, N) and torques (torques, N)."""
        parts, count = self.parts, len(self.t)
        inputs = [parts.looks[name](self) for name in parts.law_inputs]
        values = parts.laws(inputs, (count,))
        springs, forces = 4 * len(parts.springs.names), len(parts.pushes.bodies)
        return (
            values[:springs].reshape(-1, 4, count),
            values[springs : springs + forces],
            values[springs + forces :],
        )

    @functools.cached_property
    def tensions(self) -> Array:
        """Forces of the springs along their z, N or N m, (springs, N)."""
        return self.parts.springs.forces(self.stretch, self.laws[0])

    @functools.cached_property
    def applied(self) -> Array:
        """All generalized forces but those of contacts and loops, gravity too, (n, N).

        Less what the velocities ask for by themselves: M dd(q) is equal to it.
        """
        total = self.inertial
        if self.parts.drives:
            total = total + self.driven
        if self.parts.springs.names:
            total = total + np.einsum("snN,sN->nN", self.stretch.slope, self.tensions)
        if self.parts.pushes.bodies or len(self.parts.pushes.rows):
            _, forces, torques = self.laws
            total = total + self.parts.pushes.generalized(self.pose, forces, torques)
        return np.asarray(total)
