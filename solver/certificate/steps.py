"""A phase of time steps through contact: the mechanism at the knots and along the steps."""

import functools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from schemas import resolve
from schemas.errors import InvalidModel
from schemas.expressions import ExpressionError
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.results import PhaseResult
from solver.certificate.published import Published, Stops, stops, stops_of
from solver.certificate.slipping import slipped
from solver.numeric import Array, MalformedCurves, gauss
from solver.simulation.instant import Instant
from solver.simulation.multibody import Multibody

Number = TypeVar("Number", np.float64, np.complex128)

POINTS = 12
"""Gauss points of the integrals along a step."""


@dataclass(frozen=True)
class Steps:
    """The steps of a phase, and the mechanism at their ends and along them.

    A step goes straight from q to q of the next knot. Not slotted: what is asked for more than
    once is kept.

    Attributes
    ----------
    method
        With what the steps were made.
    before
        For each body the one whose motion goes on as its own where the phase is periodic; None
        where it starts anew.
    """

    model: Multibody
    method: ContactImplicit
    published: Published
    parameters: Mapping[str, float] = field(default_factory=dict)
    before: Sequence[int] | None = None

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        method: ContactImplicit,
        result: PhaseResult,
        statics: Mapping[str, float],
        before: Sequence[int] | None = None,
    ) -> "Steps":
        """Read a result.

        Raises
        ------
        MalformedCurves
            Where it lacks a series, or the mechanism cannot be read.
        """
        try:
            model = Multibody.of(mechanism, statics)
        except (InvalidModel, ExpressionError) as reason:
            raise MalformedCurves(f"the mechanism cannot be read: {reason}") from None
        known = {**statics, **resolve.parameters(mechanism)}
        return cls(model, method, Published.read(mechanism, method, result), known, before)

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
    def knots(self) -> Instant:
        """The mechanism at all knots."""
        told = self.published
        u = np.concatenate([told.u[:, :1], told.u], axis=1)
        return self.model.at(told.knots, told.q, told.v, u)

    @functools.cached_property
    def last(self) -> Instant:
        """At the ends of the steps, under the steps' own velocities, controls and forces."""
        told = self.published
        return self.model.at(self.ends, told.q[:, 1:], self.chords, told.u)

    def along(self, shares: Array) -> Instant:
        """At parts (k,) of each step, under what acts in it: N k points, step by step."""
        told, k = self.published, len(shares)
        q = told.q[:, :-1, None] + self.moved[..., None] * shares
        times = told.knots[:-1, None] + self.lengths[:, None] * shares
        v, u = np.repeat(self.chords, k, axis=1), np.repeat(told.u, k, axis=1)
        return self.model.at(times.ravel(), q.reshape(len(q), -1), v, u)

    @functools.cached_property
    def inside(self) -> Instant:
        """At the Gauss points of every step."""
        return self.along((gauss(POINTS)[0] + 1) / 2)

    def mean(self, values: NDArray[Number]) -> NDArray[Number]:
        """The mean over each step (..., N) of what is given at `inside`, (..., N points)."""
        weights = gauss(POINTS)[1] / 2
        found: NDArray[Number] = (
            values.reshape(*values.shape[:-1], len(self.ends), POINTS) @ weights
        )
        return found

    def forces(self, owner: str, names: Iterable[str], word: str = "") -> Array:
        """Published forces of some owners of a kind, (owners, N)."""
        told = self.published.forces
        rows = [told[f"{owner}.{name}{word}"] for name in names]
        return np.reshape(rows, (len(rows), len(self.ends)))

    @property
    def normal(self) -> Array:
        """N, (pairs, N)."""
        return self.forces("contact", self.model.pairs, ".normal")

    @property
    def tangential(self) -> Array:
        """N, (pairs, N)."""
        return self.forces("contact", self.model.pairs, ".tangential")

    @property
    def pins(self) -> tuple[Array, Array]:
        """The forces of the loops along x and y, N, (loops, N) each."""
        loops = self.model.parts.loop_names
        return self.forces("loop", loops, ".x"), self.forces("loop", loops, ".y")

    @functools.cached_property
    def stops(self) -> Stops:
        """Both sides of every joint with limits; one that is open is infinitely far."""
        axes, mechanism = self.model.parts.axes, self.model.mechanism
        joints = []
        for joint in stops(mechanism) if self.method.stops else []:
            limits = getattr(mechanism.joints[joint], "limits", None)
            offset = float(axes.offsets[axes.names.index(joint)])
            sides = resolve.interval(limits, self.parameters)
            joints.append((joint, axes.row(joint), offset, sides))
        return stops_of(joints, self.published)

    @functools.cached_property
    def gaps(self) -> Array:
        """Of all contacts at the knots, m, (pairs, N + 1)."""
        return self.knots.contacts.gaps

    @functools.cached_property
    def rooms(self) -> Array:
        """How far all limits are at the knots, (stops, N + 1)."""
        found = self.stops
        return np.asarray(found.slopes @ self.published.q + found.offsets[:, None])

    @functools.cached_property
    def swept(self) -> Array:
        """By how much the touching matter slips on the straight way of each step, m, (pairs, N)."""
        slopes = self.mean(self.inside.contacts.Jt)
        return np.asarray(np.einsum("pnN,nN->pN", slopes, self.moved))

    @functools.cached_property
    def slid(self) -> Array:
        """The way that friction works on, m, (pairs, N): by ends of steps where these are exact."""
        if not self.faithful:
            return self.swept
        mechanism = self.model.mechanism
        others = (pair.against for pair in mechanism.touching.values())
        shapes = [mechanism.shapes.get(name) for name in others]
        return slipped(self.knots, [one is not None and one.circle is not None for one in shapes])

    @functools.cached_property
    def slips(self) -> Array:
        """The slip that the steps' friction is opposed to, m/s, (pairs, N)."""
        return self.slid / self.lengths if self.faithful else self.last.contacts.slips

    @property
    def pairs(self) -> Sequence[str]:
        """The contacts that are permitted."""
        return self.model.pairs

    @property
    def pressing(self) -> Array:
        """Forces of contacts over the weight, (pairs, N)."""
        return np.asarray((np.abs(self.normal) + np.abs(self.tangential)) / self.weight)

    @property
    def strayed(self) -> Array:
        """By how much slips are off the way of the touching matter, m, (pairs, N)."""
        return np.abs(self.slips * self.lengths - self.swept)

    def gaps_between(self, shares: Array) -> tuple[Array, Array]:
        """Times, (N k,), and the gaps at parts (k,) of each step, m, (pairs, N k)."""
        at = self.along(shares)
        return at.t, at.contacts.gaps

    @property
    def first_rates(self) -> Array:
        """Of gaps and rooms at the first knot, (pairs + stops,)."""
        rates = self.knots.contacts.gap_rates[:, 0]
        return np.concatenate([rates, self.stops.slopes @ self.published.v[:, 0]])

    @functools.cached_property
    def weight(self) -> float:
        """The total weight, N; without gravity the largest effort of a motor, else 1."""
        parts = self.model.parts
        weight = float(parts.masses.sum() * abs(parts.gravity))
        if weight > 0:
            return weight
        largest = float(np.max(np.abs(self.last.motors), initial=0.0))
        return largest if largest > 0 else 1.0
