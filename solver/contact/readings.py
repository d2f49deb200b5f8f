"""Gaps, slips and impulses of the steps of a phase, by the numbers of the simulator.

Nothing of the program's own slacks enters: gaps and slips are those of the published places.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from schemas import resolve
from schemas.expressions import constant
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.phases import Phase
from schemas.results import PhaseResult
from schemas.urdf import Urdf
from solver.certificate.spatial_slipping import spatial_slipped
from solver.contact.flicker import FRICTIONLESS, Array, Pressed, Steps
from solver.contact.forces import typical_force
from solver.numeric.quadrature import gauss
from solver.simulation.multibody import Multibody
from solver.simulation.spatial import SpatialMultibody
from solver.trajectory import Trajectory

_POINTS = 5
"""Places along a step at which slips are averaged: exact to round-off for turns below 1 rad."""

Statics = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Stepped:
    """A phase in N steps: times and coordinates at the knots, forces over the steps.

    Attributes
    ----------
    knots
        s, (N + 1,).
    q
        Coordinates, (n, N + 1).
    forces
        By their published names, N or N m, (N,) each; those that are not there are not known.
    """

    knots: Array
    q: Array
    forces: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def of_result(cls, phase: Phase, result: PhaseResult) -> "Stepped":
        """What was published of a phase."""
        states, forces = result.groups["states"].values, result.groups.get("forces")
        return cls(
            np.array(result.knots),
            np.array([states[name] for name in _coordinates(phase)], dtype=float),
            {
                name: np.array(values, dtype=float)
                for name, values in (forces.values if forces else {}).items()
            },
        )

    @classmethod
    def of_guess(cls, phase: Phase, guess: Trajectory, fractions: Array) -> "Stepped":
        """A guess at the knots, fractions of its duration (N + 1,).

        Forces that a guess does not have, or that are zero all along, are not known.
        """
        names = [f"contact.{pair}.{word}" for pair in _touching(phase) for word in _WORDS]
        known = [name for name in names if guess.curve(name) is not None]
        values = guess.sample(known, fractions[1:]) if known else np.zeros((0, 0))
        return cls(
            guess.start + (guess.end - guess.start) * fractions,
            guess.sample(_coordinates(phase), fractions),
            {name: row for name, row in zip(known, values, strict=True) if np.any(row)},
        )

    @property
    def lengths(self) -> Array:
        """Of the steps, s."""
        return np.diff(self.knots)

    def impulse(self, name: str) -> Array | None:
        """Of a force over each step, N s or N m s; None where it is not known."""
        force = self.forces.get(name)
        return None if force is None else force * self.lengths


class Readings(NamedTuple):
    """What may touch: by its name, every way in which it may."""

    steps: Steps
    rows: dict[str, list[Pressed]]


_WORDS = ("normal", "tangential")


def readings(phase: Phase, stepped: Stepped, statics: Statics, *, guessed: bool) -> Readings:
    """All contacts and limited joints of a phase.

    Of a result those that have no published force are left out; of a guess none is.
    """
    system, method = phase.system, phase.method
    chosen = method if isinstance(method, ContactImplicit) else None
    ends = chosen is not None and chosen.discretisation == "backward_euler"
    with np.errstate(all="ignore"):  # what diverged is read as far as it goes
        if isinstance(system, Mechanism):
            contacts, speed = _planar(system, stepped, statics, ends=ends)
        elif isinstance(system, Urdf):
            contacts, speed = _spatial(system, stepped, statics, ends=ends)
        else:
            return Readings(Steps(stepped.lengths, 1.0), {})
    rows = {name: [one] for name, one in contacts.items() if guessed or one.impulses is not None}
    if chosen is not None and chosen.friction == "no_slip":
        rows = {name: [Pressed(one.gaps, one.impulses)] for name, (one,) in rows.items()}
    rows |= _limits(system, stepped, statics, guessed=guessed)
    return Readings(Steps(stepped.lengths, typical_force(system, phase), speed), rows)


def _planar(
    system: Mechanism, stepped: Stepped, statics: Statics, *, ends: bool
) -> tuple[dict[str, Pressed], float]:
    """Contacts, and the fastest slip, m/s."""
    model = Multibody.of(system, statics)
    gaps = model.contacts(stepped.q, np.zeros_like(stepped.q)).gaps
    slips = _slips(model, stepped, ends=ends)
    found = {}
    for name, gap, slip, friction in zip(model.pairs, gaps, slips, model.friction, strict=True):
        normal = stepped.impulse(f"contact.{name}.normal")
        tangential = stepped.impulse(f"contact.{name}.tangential")
        spare = None
        if normal is not None and tangential is not None:
            spare = np.maximum(friction * normal - np.abs(tangential), 0.0)
        found[name] = (
            Pressed(gap, normal, slip, spare)
            if friction > 0
            else Pressed(gap, normal, word=FRICTIONLESS)
        )
    return found, _fastest(slips)


def _slips(model: Multibody, stepped: Stepped, *, ends: bool) -> Array:
    """Slips of the steps, (pairs, N): at their ends, or averaged along them."""
    before, after = stepped.q[:, :-1], stepped.q[:, 1:]
    chord = (after - before) / stepped.lengths
    if ends:
        return model.contacts(after, chord).slips
    places, weights = gauss(_POINTS)
    found = [
        weight * model.contacts(before + (place + 1) / 2 * (after - before), chord).slips
        for place, weight in zip(places, weights, strict=True)
    ]
    return np.asarray(sum(found) / 2)


def _spatial(
    system: Urdf, stepped: Stepped, statics: Statics, *, ends: bool
) -> tuple[dict[str, Pressed], float]:
    """Contacts with their slips along x and y, and the fastest slip, m/s.

    Slips are at the ends of the steps, or from where the matter was before to where it is after.
    """
    model = SpatialMultibody.of(system, statics)
    chord, at = np.diff(stepped.q) / stepped.lengths, model.at(0.0, stepped.q)
    way = dict(zip(at.centres, np.moveaxis(spatial_slipped(at), 1, 0), strict=True))
    friction = constant(system.ground.friction.tree, {**statics, **resolve.parameters(system)})
    found, fastest = {}, 0.0
    for name in system.touching:
        slips = way[name] / stepped.lengths
        if ends:
            words = [f"contact.{name}.{word}" for word in ("slip_x", "slip_y")]
            none = np.zeros((len(model.controls), chord.shape[1]))
            slips = model.values(words, 0.0, stepped.q[:, 1:], chord, none)
        gaps = at.gap(name)
        normal, *along = (
            stepped.impulse(f"contact.{name}.{word}")
            for word in ("normal", "tangential_x", "tangential_y")
        )
        spare = None
        if normal is not None and along[0] is not None and along[1] is not None:
            spare = np.maximum(friction * normal - np.hypot(along[0], along[1]), 0.0)
        fastest = max(fastest, _fastest(np.hypot(*slips)))
        found[name] = (
            Pressed(gaps, normal, slips, spare)
            if friction > 0
            else Pressed(gaps, normal, word=FRICTIONLESS)
        )
    return found, fastest


def _limits(
    system: Mechanism | Urdf, stepped: Stepped, statics: Statics, *, guessed: bool
) -> dict[str, list[Pressed]]:
    """Both stops of each limited joint; their effort is published as lower less upper."""
    found = {}
    for joint, (at, lower, upper) in _travels(system, stepped, statics).items():
        effort = stepped.impulse(f"limit.{joint}")
        if effort is None and not guessed:
            continue
        pushes = (None, None) if effort is None else (effort.clip(0.0), (-effort).clip(0.0))
        found[f"limit.{joint}"] = [
            Pressed(room, push, word=word)
            for word, room, push in zip(
                ("lower", "upper"), (at - lower, upper - at), pushes, strict=True
            )
            if np.isfinite(room).any()
        ]
    return {name: sides for name, sides in found.items() if sides}


def _travels(
    system: Mechanism | Urdf, stepped: Stepped, statics: Statics
) -> dict[str, tuple[Array, float, float]]:
    """Each limited joint: where it is at the knots, and between which limits it moves."""
    if isinstance(system, Urdf):
        places = dict(zip(system.coordinates, stepped.q, strict=True))
        return {
            name: (places[name], *limits)
            for name, limits in system.intervals.items()
            if name in places
        }
    constants = {**statics, **resolve.parameters(system)}
    model, found = Multibody.of(system, statics), {}
    at = model.at(0.0, stepped.q)
    for row, name in enumerate(model.parts.axes.names):
        bound = getattr(system.joints[name], "limits", None)
        if bound is not None:
            lower, upper = resolve.interval(bound, constants)
            found[name] = np.asarray(at.joints[0][row]), lower, upper
    return found


def _fastest(slips: Array) -> float:
    known = np.abs(slips[np.isfinite(slips)])
    return float(known.max()) if known.size else 0.0


def _coordinates(phase: Phase) -> list[str]:
    return phase.system.coordinates if isinstance(phase.system, Mechanism | Urdf) else []


def _touching(phase: Phase) -> list[str]:
    return list(phase.system.touching) if isinstance(phase.system, Mechanism | Urdf) else []
