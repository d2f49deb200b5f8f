"""Rigid bodies in the plane: the equations of motion of a mechanism, by body Jacobians, in numpy.

``M(q) dd(q) = forces + Jn' normal + Jt' tangential + loops``, with M the sum over bodies of
``J' diag(m, m, I) J``: no recursion, and nothing shared with ``solver.mechanics``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.mechanisms import Mechanism
from solver.numeric.tape import Array
from solver.simulation.constants import Constants
from solver.simulation.holding import Held, solve
from solver.simulation.instant import Instant, Parts
from solver.simulation.kinematics import Points
from solver.simulation.naming import named
from solver.simulation.touch import Contacts


@dataclass(frozen=True, slots=True)
class Multibody:
    """A mechanism of known numbers.

    Arrays have the names first and any number of points after: ``q`` is (n, ...), with the shape
    ``...`` common to all arguments, ``t`` included; matrices come out as (..., n, n). ``controls``
    are the names of u.
    """

    mechanism: Mechanism
    parts: Parts
    statics: Mapping[str, float]
    controls: tuple[str, ...]

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        statics: Mapping[str, float] | None = None,
        more: Sequence[str] = (),
    ) -> "Multibody":
        """Read a mechanism.

        Parameters
        ----------
        statics
            Numbers beside its own parameters.
        more
            Names beside its own controls that come with these: their derivatives.

        Raises
        ------
        ExpressionError
            Where a constant has no value.
        InvalidModel
            Where a force depends on what is not known before the forces are.
        """
        given = dict(statics or {})
        parts = named(mechanism, Constants.of(mechanism, given), more)
        return cls(mechanism, parts, given, (*mechanism.control_names, *more))

    @property
    def coordinates(self) -> list[str]:
        """Names of q."""
        return self.mechanism.coordinates

    @property
    def pairs(self) -> tuple[str, ...]:
        """Names of the pairs that may touch, in the order of `contacts`."""
        return self.parts.touch.names

    @property
    def friction(self) -> Array:
        """Coefficients of the pairs, (pairs,)."""
        return self.parts.touch.friction

    @property
    def restitution(self) -> Array:
        """Coefficients of the pairs, (pairs,)."""
        return self.parts.touch.restitution

    def at(
        self, t: Array | float, q: Array, v: Array | None = None, u: Array | None = None
    ) -> Instant:
        """Everything at some points in time, which are made one axis: (names, N)."""
        q = np.asarray(q, dtype=float)
        flat = q.reshape(len(q), -1)
        count = flat.shape[1]
        v = np.zeros_like(flat) if v is None else np.reshape(v, flat.shape)
        u = np.zeros((len(self.controls), count)) if u is None else np.reshape(u, (-1, count))
        times = np.broadcast_to(np.asarray(t, dtype=float), q.shape[1:]).reshape(count)
        return Instant(self.parts, times, flat, v, u)

    def mass(self, q: Array) -> Array:
        """The mass matrix, (..., n, n)."""
        n = len(q)
        return self.at(0.0, q).mass.reshape(*np.shape(q)[1:], n, n)

    def forces(self, t: Array | float, q: Array, v: Array, u: Array) -> Array:
        """All generalized forces but those of contacts and loops, minus bias: (..., n)."""
        return self.at(t, q, v, u).applied.T.reshape(*np.shape(q)[1:], len(q))

    def contacts(self, q: Array, v: Array) -> Contacts:
        """Every pair: names first, then what `Contacts` says; points are made one axis."""
        return self.at(0.0, q, v).contacts

    def loops(self, q: Array, v: Array) -> Points:
        """How far each loop is open, from its first place to its second, and its slopes."""
        return self.at(0.0, q, v).loops

    def accelerations(
        self,
        t: Array | float,
        q: Array,
        v: Array,
        u: Array,
        mode: Mapping[str, str] | None = None,
        given: Mapping[str, Array] | None = None,
    ) -> Held:
        """Accelerations, and the forces of contacts and loops.

        Parameters
        ----------
        mode
            What each touching pair does; the mechanism's own unless given.
        given
            Forces that are known, such as ``contact.heel.tangential``: their rows are not held.
            Those that are ``loose`` are controls, and known from these.
        """
        at = self.at(t, q, v, u)
        shape = np.shape(q)[1:]
        known = {name: at.u[self.controls.index(name)] for name in self.mechanism.loose}
        known |= given or {}
        held = solve(at, self.mechanism.mode if mode is None else mode, known)
        return Held(
            held.accelerations.reshape(-1, *shape),
            {name: force.reshape(shape) for name, force in held.forces.items()},
        )

    def energy(self, q: Array, v: Array, t: Array | float = 0.0) -> tuple[Array, Array]:
        """Kinetic and potential energy (of gravity and springs), J, (...) each."""
        at, shape = self.at(t, q, v), np.shape(q)[1:]
        return at.kinetic.reshape(shape), at.potential.reshape(shape)

    def momentum(self, q: Array, v: Array) -> Array:
        """Linear (x, y), N s, and angular about the com, N m s: (3, ...)."""
        at = self.at(0.0, q, v)
        rows = np.array([at.momentum.real, at.momentum.imag, at.spin])
        return rows.reshape(3, *np.shape(q)[1:])

    def frames(self, q: Array) -> Array:
        """Every body's origin x, y and angle, in the order of ``bodies``: (bodies, 3, ...)."""
        pose = self.at(0.0, q).pose
        z = self.parts.kinematics.places[1:] @ pose.features
        rows = np.stack([z.real, z.imag, pose.angles[1:]], axis=1)
        return rows.reshape(len(z), 3, *np.shape(q)[1:])

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, parents first."""
        return self.parts.kinematics.bodies

    def values(self, names: Sequence[str], t: Array | float, q: Array, v: Array, u: Array) -> Array:
        """Names that need no forces of contacts: places, gaps, energies: (names, ...)."""
        at, shape = self.at(t, q, v, u), np.shape(q)[1:]
        rows = [self.parts.looks[name](at) for name in names]
        return np.reshape(rows, (len(names), *shape))
