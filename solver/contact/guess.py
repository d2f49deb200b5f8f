"""Where a solve through contact starts: slacks of the guessed motion, feet that bear the weight."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from footfall.curves import Curves
from schemas.expressions import Name
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.phases import Phase as PhaseSpec
from schemas.problem import Problem
from schemas.urdf import Urdf
from solver.contact.expand import Contacts
from solver.contact.forces import typical_force
from solver.contact.names import LimitNames
from solver.contact.slacks import Guessed
from solver.lowering import STRETCH
from solver.model import Model, Phase
from solver.numeric import along
from solver.numeric.tape import Array
from solver.trajectory import Trajectory
from solver.trajectory.trajectory import straight_lines

ROUND = 1e-6
"""What is smaller all along is nothing: the round-off of a guess is no size of its variable."""

NEAR = 1e-3
"""Part of the largest gap, or metres where that is smaller, at which a guessed contact bears."""


def with_contacts(
    contacts: Contacts, posted: Problem, model: Model, guesses: Sequence[Trajectory]
) -> list[Trajectory]:
    """The guesses of all phases, completed where there are contacts."""
    found = list(guesses)
    statics = {one.name: one.guess for one in model.statics}
    for index, method in (contacts.methods or {}).items():
        spec, phase = posted.phases[index], model.phases[index]
        found[index] = _Filling.of(spec, phase, method, found[index], statics).filled()
    return found


@dataclass(frozen=True, slots=True)
class _Filling:
    """One phase's guess, sampled at ``fractions`` (n,) of its duration.

    ``rates`` are those of the guessed coordinates; ``force`` is what contacts near the ground bear
    together.
    """

    system: Mechanism | Urdf
    phase: Phase
    guess: Trajectory
    statics: Mapping[str, float]
    fractions: Array
    rates: Mapping[str, Array]
    force: float

    @classmethod
    def of(
        cls,
        spec: PhaseSpec,
        phase: Phase,
        method: ContactImplicit,
        guess: Trajectory,
        statics: Mapping[str, float],
    ) -> "_Filling":
        """Sampled twice as densely as there are steps, or as the guess itself."""
        if not isinstance(spec.system, Mechanism | Urdf):
            raise TypeError("no contacts of their own")
        fractions = np.linspace(0.0, 1.0, max(2 * method.segments + 1, len(guess.states.breaks)))
        rates = _moving(guess, spec.system, fractions)
        if STRETCH in phase.states:
            rates[STRETCH] = np.ones(len(fractions))
        force = typical_force(spec.system, spec) if method.bearing else 0.0
        return cls(spec.system, phase, guess, statics, fractions, rates, force)

    def filled(self) -> Trajectory:
        """With rates, forces and slacks."""
        slacks = self._contacts()
        system = self.system
        for joint in system.joints if isinstance(system, Mechanism) else system.coordinates:
            slacks |= _of_limits(LimitNames(joint), self.guess, self.fractions)
        known = {name: row for name, row in slacks.items() if name in self.phase.controls}
        return replace(
            self.guess,
            states=self._lines(self.guess.states, self.rates),
            controls=self._lines(self.phase.controls, known),
        )

    def _contacts(self) -> dict[str, Array]:
        """Forces, gaps and slips of all pairs."""
        gaps = {pair: self._value(f"contact.{pair}.gap") for pair in self.system.touching}
        rows: dict[str, Array] = {}
        for (pair, gap), bears in zip(gaps.items(), _bearing(list(gaps.values())), strict=True):
            own = f"contact.{pair}"
            normal = self._given(f"{own}.normal", bears * self.force)
            words = ("",) if isinstance(self.system, Mechanism) else ("_x", "_y")
            slips = [np.nan_to_num(self._value(f"{own}.slip{word}")) for word in words]
            pushes = [self._given(f"{own}.tangential{word}", 0.0 * gap) for word in words]
            touch = Guessed(gap, normal, np.array(slips), np.array(pushes))
            rows |= (
                touch.planar(pair)
                if isinstance(self.system, Mechanism)
                else touch.spatial(pair, self.phase.controls)
            )
        return rows

    def _value(self, name: str) -> Array:
        """What a name is along the guess."""
        guess, fractions = self.guess, self.fractions
        times = guess.start + (guess.end - guess.start) * fractions
        run = along(self.phase.form, [Name(name)], self.statics)
        states = self.phase.states
        x = np.array([self.rates.get(one, guess.sample([one], fractions)[0]) for one in states])
        u = guess.sample(self.phase.controls, fractions)
        return np.asarray(run(times, x, u)[0], dtype=float)

    def _given(self, name: str, otherwise: Array) -> Array:
        """A force of the guess; zeros all along are what a guess has of what it does not know."""
        known = self.guess.sample([name], self.fractions)[0]
        return np.asarray(known if np.any(known) else otherwise)

    def _lines(self, names: Iterable[str], known: Mapping[str, Array]) -> Curves:
        """Straight lines through the guess at the samples; through what is ``known`` instead."""
        rows = {name: self.guess.sample([name], self.fractions)[0] for name in names} | {**known}
        rows = {name: np.where(np.any(np.abs(row) > ROUND), row, 0.0) for name, row in rows.items()}
        times = self.guess.start + (self.guess.end - self.guess.start) * self.fractions
        return straight_lines(list(rows), times, np.array(list(rows.values())))


def _moving(guess: Trajectory, system: Mechanism | Urdf, fractions: Array) -> dict[str, Array]:
    """Rates as slopes of the guessed coordinates, where nothing is known of them."""
    count = len(system.coordinates)
    rates = dict(zip(system.state_names[count:], system.coordinates, strict=True))
    span = max(guess.end - guess.start, 1e-9)
    found = {}
    for rate, coordinate in rates.items():
        own = guess.sample([rate], fractions)[0]
        if np.any(own != own[0]):
            continue
        q = guess.sample([coordinate], fractions)[0]
        if np.any(q != q[0]):
            found[rate] = np.gradient(q, span * fractions)
    return found


def _bearing(gaps: Sequence[Array]) -> list[Array]:
    """Each contact's part of the weight: the same for all that are near the ground."""
    if not gaps:
        return []
    near = [gap <= NEAR + NEAR * np.max(np.abs(gap)) for gap in gaps]
    count = np.maximum(np.sum(near, axis=0), 1)
    return [np.asarray(one / count) for one in near]


def _of_limits(names: LimitNames, guess: Trajectory, fractions: Array) -> dict[str, Array]:
    effort = guess.curve(names.effort)
    if effort is None:
        return {}
    both = guess.sample([names.effort], fractions)[0]
    return {names.lower: np.maximum(both, 0.0), names.upper: np.maximum(-both, 0.0)}
