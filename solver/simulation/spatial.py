"""Rigid bodies in space: its equations of motion by body Jacobians, in numpy.

``M(q) dd(q) = forces + J' contact forces``, with M the sum over links of
``m Jv' Jv + Jw' I Jw``: no recursion of forces, and nothing shared with ``solver.mechanics``.
The norm of a quaternion does not enter the motion, so M is singular along it; ``p p'`` is added
there and its own equation, ``p'dd(p) = -d(p)'d(p)``, on the right.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from schemas import resolve
from schemas.urdf import Mode, Urdf, contact_forces
from solver.numeric.tape import Array
from solver.simulation.holding import NOTHING, Held
from solver.simulation.scope import Vocabulary
from solver.simulation.spatial_instant import Numbers, SpatialInstant, SpatialParts
from solver.simulation.spatial_looks import looks

_DEPENDENT = 1e-10
"""Singular values below this share of the largest belong to rows that others imply."""


@dataclass(frozen=True, slots=True)
class SpatialMultibody:
    """Links and joints of known numbers; has what `solver.simulation.multibody.Multibody` has.

    Arrays have the names first and any number of points after.
    """

    parts: SpatialParts
    statics: Mapping[str, float]

    @classmethod
    def of(
        cls, system: Urdf, statics: Mapping[str, float] | None = None, more: Sequence[str] = ()
    ) -> "SpatialMultibody":
        """Read a system; ``more`` are names of further controls, such as derivatives of its own.

        Raises
        ------
        ExpressionError
            Where a constant has no value.
        InvalidModel
            Where a force depends on what is not known before the forces are.
        """
        given = dict(statics or {})
        known = {**given, **resolve.parameters(system)}
        bare = SpatialParts(system, Numbers.of(system, known), tuple(more))
        supplied = looks(cls(bare, given).at(0.0, np.ones((len(system.coordinates), 1))))
        definitions = {name: one.tree for name, one in system.define.items()}
        words = Vocabulary(known, definitions, supplied.__contains__)
        trees = [force.value.tree for force in system.forces.values()]
        laws, inputs = words.record(trees)
        return cls(replace(bare, laws=laws, law_inputs=inputs, looks=supplied), given)

    @property
    def system(self) -> Urdf:
        """What is moving."""
        return self.parts.system

    @property
    def numbers(self) -> Numbers:
        """Its constants."""
        return self.parts.numbers

    @property
    def coordinates(self) -> list[str]:
        """Names of q."""
        return self.system.coordinates

    @property
    def controls(self) -> list[str]:
        """Names of u."""
        return self.parts.controls

    @property
    def bodies(self) -> list[str]:
        """Names of the links, parents first."""
        return [one.link for one in self.system.carriages]

    def at(
        self, t: Array | float, q: Array, v: Array | None = None, u: Array | None = None
    ) -> SpatialInstant:
        """Everything at some points in time, which are made one axis: (names, N)."""
        q = np.asarray(q, dtype=float)
        flat = q.reshape(len(q), -1)
        count = flat.shape[1]
        v = np.zeros_like(flat) if v is None else np.reshape(v, flat.shape)
        u = np.zeros((len(self.controls), count)) if u is None else np.reshape(u, (-1, count))
        times = np.broadcast_to(np.asarray(t, dtype=float), q.shape[1:]).reshape(count)
        return SpatialInstant(self.parts, times, flat, v, u)

    def mass(self, q: Array) -> Array:
        """The mass matrix, (..., n, n); singular along the norms of quaternions."""
        n = len(q)
        return self.at(0.0, q).mass.reshape(*np.shape(q)[1:], n, n)

    def forces(self, t: Array | float, q: Array, v: Array, u: Array) -> Array:
        """All generalized forces but those of contacts, minus bias: (..., n)."""
        return self.at(t, q, v, u).applied.reshape(*np.shape(q)[1:], len(q))

    def accelerations(
        self,
        t: Array | float,
        q: Array,
        v: Array,
        u: Array,
        mode: Mapping[str, Mode] | None = None,
        given: Mapping[str, Array] | None = None,
    ) -> Held:
        """Accelerations, and the forces of contacts that touch; see `Multibody.accelerations`."""
        at, shape = self.at(t, q, v, u), np.shape(q)[1:]
        held = _solve(at, self.system.mode if mode is None else mode, given or NOTHING)
        forces = {name: np.reshape(force, shape) for name, force in held.forces.items()}
        return Held(held.accelerations.reshape(-1, *shape), forces)

    def energy(self, q: Array, v: Array, t: Array | float = 0.0) -> tuple[Array, Array]:
        """Kinetic and potential energy, J, (...) each."""
        at, shape = self.at(t, q, v), np.shape(q)[1:]
        return at.kinetic.reshape(shape), at.potential.reshape(shape)

    def momentum(self, q: Array, v: Array) -> Array:
        """Linear, N s, and angular about the com, N m s: (6, ...)."""
        at = self.at(0.0, q, v)
        both = np.concatenate([at.momentum, at.angular], axis=1).T
        return both.reshape(6, *np.shape(q)[1:])

    def values(self, names: Sequence[str], t: Array | float, q: Array, v: Array, u: Array) -> Array:
        """Names that need no forces of contacts: places, gaps, energies: (names, ...)."""
        at, shape = self.at(t, q, v, u), np.shape(q)[1:]
        return np.reshape([self.parts.looks[name](at) for name in names], (len(names), *shape))


def _solve(at: SpatialInstant, mode: Mapping[str, Mode], given: Mapping[str, Array]) -> Held:
    """Accelerations (n, N) and forces (N,) under a mode."""
    mass, force = _with_norms(at)
    names, rows, bias = [], [], []
    for name, doing in mode.items():
        J, drift = at.rows(name)
        for one in contact_forces(name, doing):
            k = "lxy".index(one[-1])  # normal, tangential_x, tangential_y
            if one in given:
                force = force + J[:, k] * np.reshape(given[one], (-1, 1))
            else:
                names.append(one)
                rows.append(J[:, k])
                bias.append(drift[:, k])
    if not rows:
        found = np.linalg.solve(mass, force[..., None])[..., 0]
        return Held(np.asarray(found.T, dtype=float), dict(given))
    J = np.stack(rows, axis=1)
    both = np.linalg.solve(mass, np.concatenate([np.swapaxes(J, 1, 2), force[..., None]], axis=2))
    asked = -(J @ both[..., -1:])[..., 0] - np.stack(bias, axis=1)
    shares = np.linalg.pinv(J @ both[..., :-1], rcond=_DEPENDENT) @ asked[..., None]
    found = both[..., -1] + (both[..., :-1] @ shares)[..., 0]
    return Held(
        np.asarray(found.T, dtype=float),
        {**given, **{name: shares[:, k, 0] for k, name in enumerate(names)}},
    )


def _with_norms(at: SpatialInstant) -> tuple[Array, Array]:
    """Mass matrix and forces with an equation for the norm of every quaternion."""
    mass, force = at.mass.copy(), at.applied.copy()
    rows = {name: row for row, name in enumerate(at.system.coordinates)}
    for one in at.system.carriages:
        for step in one.steps:
            if step.kind == "ball":
                which = [rows[name] for name in step.coordinates]
                p, rate = at.q[which], at.v[which]
                along = np.zeros_like(at.q)
                weight = np.sqrt(np.trace(mass[:, which][:, :, which], axis1=1, axis2=2))
                along[which] = p * weight
                mass += along.T[:, :, None] * along.T[:, None, :]
                force -= along.T * (weight * np.sum(rate * rate, axis=0))[:, None]
    return mass, force
