"""A phase of time steps through contact in space: links at the knots and along the steps.

It has what `solver.certificate.steps.Steps` has, by the spatial simulator. Contacts are with level
ground.
"""

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel
from schemas.expressions import ExpressionError, constant
from schemas.methods import ContactImplicit
from schemas.results import PhaseResult
from schemas.urdf import Urdf
from solver.certificate.published import Published, Stops, stops, stops_of
from solver.certificate.spatial_slipping import spatial_slipped
from solver.certificate.steps import POINTS
from solver.numeric import Array, MalformedCurves, gauss
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_instant import SpatialInstant


@dataclass(frozen=True)
class SpatialSteps:
    """The steps of a URDF system. A step goes straight from q to q of the next knot.

    Not slotted: what is asked for more than once is kept. In a ``periodic`` phase the last step
    comes before the first.
    """

    model: SpatialMultibody
    method: ContactImplicit
    published: Published
    parameters: Mapping[str, float] = field(default_factory=dict)
    periodic: bool = False

    @classmethod
    def of(
        cls,
        system: Urdf,
        method: ContactImplicit,
        result: PhaseResult,
        statics: Mapping[str, float],
        *,
        periodic: bool = False,
    ) -> "SpatialSteps":
        """Read a result.

        Raises
        ------
        MalformedCurves
            Where it lacks a series, or the system cannot be read.
        """
        try:
            model = SpatialMultibody.of(system, statics)
        except (InvalidModel, ExpressionError) as reason:
            raise MalformedCurves(f"the system cannot be read: {reason}") from None
        known = {**statics, **resolve.parameters(system)}
        return cls(model, method, Published.read(system, method, result), known, periodic)

    @property
    def faithful(self) -> bool:
        """Whether steps are those of the discrete gradient, not backward Euler's of 000."""
        return self.method.discretisation != "backward_euler"

    @property
    def lengths(self) -> Array:
        """(N,), s."""
        return np.diff(self.published.knots)

    @property
    def ends(self) -> Array:
        """The times at which the steps end, (N,)."""
        return self.published.knots[1:]

    @functools.cached_property
    def moved(self) -> Array:
        """By how much each step changes the coordinates, (n, N)."""
        return np.diff(self.published.q)

    @functools.cached_property
    def chords(self) -> Array:
        """The steps' own velocities, (n, N)."""
        return self.moved / self.lengths

    @functools.cached_property
    def before(self) -> Array:
        """The velocities of the steps before; the first one's are those at the start, (n, N)."""
        return np.concatenate([self.published.v[:, :1], self.chords[:, :-1]], axis=1)

    @functools.cached_property
    def knots(self) -> SpatialInstant:
        """At all knots; the velocities are those of the steps that end there."""
        told = self.published
        v = np.concatenate([told.v[:, :1], self.chords], axis=1)
        return self.model.at(told.knots, told.q, v, np.concatenate([told.u[:, :1], told.u], axis=1))

    @functools.cached_property
    def earlier(self) -> SpatialInstant:
        """Where the step before a period comes from: as long as its last one, straight."""
        told, back = self.published, self.lengths[-1:]
        q = told.q[:, :1] - back * told.v[:, :1]
        return self.model.at(told.knots[:1] - back, q, told.v[:, :1], told.u[:, :1])

    @functools.cached_property
    def first(self) -> SpatialInstant:
        """At the starts of the steps, under the velocities of those before."""
        told = self.published
        return self.model.at(told.knots[:-1], told.q[:, :-1], self.before, told.u)

    @functools.cached_property
    def last(self) -> SpatialInstant:
        """At the ends of the steps, under their own velocities and controls."""
        told = self.published
        return self.model.at(self.ends, told.q[:, 1:], self.chords, told.u)

    def along(self, shares: Array) -> SpatialInstant:
        """At parts (k,) of each step: N k points, step by step."""
        told, k = self.published, len(shares)
        q = told.q[:, :-1, None] + self.moved[..., None] * shares
        times = told.knots[:-1, None] + self.lengths[:, None] * shares
        v, u = np.repeat(self.chords, k, axis=1), np.repeat(told.u, k, axis=1)
        return self.model.at(times.ravel(), q.reshape(len(q), -1), v, u)

    @property
    def pairs(self) -> list[str]:
        """The contacts."""
        return list(self.model.system.touching)

    @property
    def normal(self) -> Array:
        """N, (pairs, N)."""
        return self._forces("normal")

    @property
    def tangential(self) -> Array:
        """Along x and y, N, (2, pairs, N)."""
        return np.array([self._forces("tangential_x"), self._forces("tangential_y")])

    def _forces(self, word: str) -> Array:
        rows = [self.published.forces[f"contact.{name}.{word}"] for name in self.pairs]
        return np.reshape(rows, (len(rows), len(self.ends)))

    @functools.cached_property
    def stops(self) -> Stops:
        """Both sides of every joint with limits; one that is open is infinitely far."""
        system, identity = self.model.system, np.eye(len(self.moved))
        joints = [
            (name, identity[system.coordinates.index(name)], 0.0, system.intervals[name])
            for name in (stops(system) if self.method.stops else [])
        ]
        return stops_of(joints, self.published)

    def depths(self, at: SpatialInstant) -> Array:
        """Gaps of all contacts, m, (pairs, ...)."""
        rows = [at.gap(name) for name in self.pairs]
        return np.reshape(rows, (len(rows), len(at.t)))

    @functools.cached_property
    def gaps(self) -> Array:
        """Of all contacts at the knots, m, (pairs, N + 1)."""
        return self.depths(self.knots)

    def gaps_between(self, shares: Array) -> tuple[Array, Array]:
        """Times, (N k,), and the gaps at parts (k,) of each step, m, (pairs, N k)."""
        at = self.along(shares)
        return at.t, self.depths(at)

    @functools.cached_property
    def first_rates(self) -> Array:
        """Of gaps and rooms at the first knot, (pairs + stops,)."""
        v = self.published.v[:, 0]
        rates = [self.first.rows(name)[0][0, 0] @ v for name in self.pairs]
        return np.concatenate([rates, self.stops.slopes @ v])

    @functools.cached_property
    def rooms(self) -> Array:
        """How far all limits are at the knots, (stops, N + 1)."""
        found = self.stops
        return np.asarray(found.slopes @ self.published.q + found.offsets[:, None])

    @functools.cached_property
    def swept(self) -> Array:
        """By how much the touching matter slips on the straight way, x and y, m, (2, pairs, N)."""
        found = self._slips(self.inside)
        mean = self.mean(np.moveaxis(found, 2, 0)).transpose(1, 2, 0)
        return np.asarray(mean * self.lengths)

    @functools.cached_property
    def slid(self) -> Array:
        """The way that friction works on along x and y, m, (2, pairs, N)."""
        return spatial_slipped(self.knots) if self.faithful else self.swept

    @functools.cached_property
    def slips(self) -> Array:
        """The slip that the steps' friction is opposed to, m/s, (2, pairs, N)."""
        return self.slid / self.lengths if self.faithful else self._slips(self.last)

    @functools.cached_property
    def inside(self) -> SpatialInstant:
        """At the Gauss points of every step."""
        return self.along((gauss(POINTS)[0] + 1) / 2)

    def mean(self, values: Array) -> Array:
        """The mean over each step (N, ...) of what is given at `inside`, (N points, ...)."""
        whole = values.reshape(len(self.ends), POINTS, *values.shape[1:])
        return np.asarray(np.einsum("Np...,p->N...", whole, gauss(POINTS)[1] / 2))

    def _slips(self, at: SpatialInstant) -> Array:
        rows = [at.slip(name).T for name in self.pairs]
        return np.moveaxis(np.reshape(rows, (len(rows), 2, len(at.t))), 1, 0)

    @property
    def pressing(self) -> Array:
        """Forces of contacts over the weight, (pairs, N)."""
        push = np.hypot(*self.tangential)
        return np.asarray((np.abs(self.normal) + push) / self.weight)

    @property
    def strayed(self) -> Array:
        """By how much slips are off the way of the touching matter, m, (pairs, N)."""
        return np.asarray(np.hypot(*(self.slips * self.lengths - self.swept)))

    @functools.cached_property
    def friction(self) -> float:
        """The ground's coefficient."""
        return constant(self.model.system.ground.friction.tree, self.parameters)

    @property
    def directions(self) -> Array:
        """Those of the friction cone, unit vectors, (directions, 2)."""
        angles = 2 * math.pi * np.arange(self.method.directions) / self.method.directions
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)

    @functools.cached_property
    def weight(self) -> float:
        """The total weight, N; without gravity the largest effort of a motor, else 1."""
        weight = self.last.mass_total * float(np.linalg.norm(self.model.numbers.gravity))
        if weight > 0:
            return weight
        motors = self.published.u[: len(self.model.system.motor_joints)]
        largest = float(np.max(np.abs(motors), initial=0.0))
        return largest if largest > 0 else 1.0
