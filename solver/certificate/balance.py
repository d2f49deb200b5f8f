"""Do forces make the motion? The balance of momentum of every step, and what is left over."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.mechanisms import GROUND, Floating, Prismatic
from solver.certificate.energies import Chords, chords, pushed, tensions
from solver.certificate.steps import Number, Steps
from solver.numeric import Array
from solver.simulation.holding import regular
from solver.simulation.kinematics import Complex

ROUND = 1e-9
"""Normals that turn by less along the steps are those of level ground, or of a plane."""


@dataclass(frozen=True, slots=True)
class Balance:
    """Momenta and impulses along the coordinates, N s or N m s, (terms, n, N): they add up to 0.

    ``terms`` are what they are of; ``doubt`` (n, N) is by how much another average that is as good
    may differ.
    """

    terms: tuple[str, ...]
    values: Array
    doubt: Array

    @property
    def left(self) -> Array:
        """What is left over, (n, N)."""
        return np.asarray(self.values.sum(axis=0))

    @property
    def beyond(self) -> Array:
        """How much of it is beyond doubt, (n, N)."""
        return np.maximum(np.abs(self.left) - self.doubt, 0.0)

    @property
    def sizes(self) -> Array:
        """All of them together, (n, N)."""
        return np.asarray(np.abs(self.values).sum(axis=0))


def averaged(steps: Steps) -> Balance:
    """With Jacobians averaged along the straight way of each step.

    Such an average times the step is the true change of what it belongs to: of a place, a gap, an
    angle. So forces do the work in it that they do on the way, and the rates of momentum are those
    of the bodies' own chords. Steps of the discrete gradient are made so; others come near to it
    as they get short.
    """
    parts, h, inside, V = steps.model.parts, steps.lengths, steps.inside, chords(steps)
    coms, turning = steps.mean(inside.coms.slopes), parts.kinematics.turning[1:]
    masses = parts.masses[:, None]
    rows = {
        "motion": -_toward(coms, masses * (V.after - V.before))
        - turning.T @ (parts.inertias[:, None] * (V.spins - V.spins_before)),
        "gravity": h * _toward(coms, masses * parts.gravity * np.ones_like(V.after)),
        "motors": h * steps.last.driven if parts.drives else np.zeros_like(steps.moved),
        "springs": h
        * np.einsum("snN,sN->nN", steps.mean(inside.stretch.slope), np.add(*tensions(steps))),
        "users": h * _users(steps),
        **_contacts(steps, steps.mean(inside.contacts.Jn), steps.mean(inside.contacts.Jt)),
        "stops": h * (steps.stops.slopes.T @ steps.stops.efforts),
        "pins": h * _pinned(steps, steps.mean(inside.loops.slopes)),
    }
    return Balance(tuple(rows), np.array(list(rows.values())), _doubt(steps, V))


def _doubt(steps: Steps, V: Chords) -> Array:
    """By how much another average may differ that gives the true changes as well.

    Places that only turn with angles have one exact average along the coordinates, but not those
    of sliders that turn, lengths between points, and contacts on what is curved. Averages differ
    by the second order of the step: by twice what the mean of both ends differs by from that along
    the way, and at curved contacts by a quarter of the square of the angle by which things turn.
    """
    parts, h, masses = steps.model.parts, steps.lengths, steps.model.parts.masses[:, None]
    slopes = _apart(steps, steps.inside.stretch.slope, steps.knots.stretch.slope)
    total = np.einsum("snN,sN->nN", slopes, np.abs(np.add(*tensions(steps)))) + _curved(steps)
    if any(parts.kinematics.turning[body].any() for body in parts.kinematics.sliders[0]):
        coms = _apart(steps, steps.inside.coms.slopes, steps.knots.coms.slopes)
        jumps = np.abs(masses * ((V.after - V.before) / h - parts.gravity))
        total += np.einsum("bnN,bN->nN", coms, jumps)
    return np.asarray(h * total)


def _curved(steps: Steps) -> Array:
    """The doubt of contacts whose normals turn along the steps, (n, N)."""
    touch, inside, turning = steps.knots.contacts, steps.inside.contacts, steps.knots.pose.angles
    curved = np.ptp(inside.normals.real, axis=1) + np.ptp(inside.normals.imag, axis=1) > ROUND
    veer = np.angle(touch.normals[:, 1:] / touch.normals[:, :-1])
    angle = np.maximum(np.abs(veer), np.abs(np.diff(turning)).max(axis=0))
    total = np.zeros_like(steps.moved)
    for force, along, ends in (
        (steps.normal, inside.Jn, touch.Jn),
        (steps.tangential, inside.Jt, touch.Jt),
    ):
        slopes = _apart(steps, along, ends) + angle[:, None] ** 2 / 4 * steps.mean(np.abs(along))
        total += np.einsum("pnN,pN->nN", slopes, np.abs(force) * curved[:, None])
    return total


def _apart(steps: Steps, along: NDArray[Number], knots: NDArray[Number]) -> Array:
    """Twice what two means of slopes differ by, (..., n, N)."""
    return 2 * np.abs(steps.mean(along) - (knots[..., :-1] + knots[..., 1:]) / 2)


def at_ends(steps: Steps) -> Balance:
    """With everything at the end of the step: backward Euler, 000, section 3.1."""
    at, h = steps.last, steps.lengths
    before = np.concatenate([steps.published.v[:, :1], steps.chords[:, :-1]], axis=1)
    rows = {
        "motion": -np.einsum("Nij,jN->iN", at.mass, steps.chords - before),
        "applied": h * at.applied,
        **_contacts(steps, at.contacts.Gn, at.contacts.Jt),
        "stops": h * (steps.stops.slopes.T @ steps.stops.efforts),
        "pins": h * _pinned(steps, at.loops.slopes),
    }
    return Balance(tuple(rows), np.array(list(rows.values())), np.zeros_like(steps.moved))


def accelerations(steps: Steps) -> tuple[Array, Array]:
    """Of the steps, and the simulator's at their ends under the published forces, (n, N) each.

    They come together as steps get short.
    """
    balance = at_ends(steps)
    push = balance.values[1:].sum(axis=0) / steps.lengths
    free = regular(steps.last.mass, push.T[..., None])[..., 0].T
    before = np.concatenate([steps.published.v[:, :1], steps.chords[:, :-1]], axis=1)
    return (steps.chords - before) / steps.lengths, np.asarray(free)


def together(steps: Steps) -> tuple[Balance, list[str]] | None:
    """Of all that floats or slides from the ground, with what it carries, and what it is called.

    Coordinates that carry everything that hangs on them along, without a turn, have the momentum
    of these bodies together: gravity, contacts and what drives sliders account for it, and no force
    in between.
    """
    mechanism, names = steps.model.mechanism, list[str]()
    for link in mechanism.links:
        if isinstance(link.joint, Floating):
            names += link.coordinates[:2]
        elif isinstance(link.joint, Prismatic) and link.parent == GROUND:
            names.append(link.coordinates[0])
    if not names:
        return None
    rows = [mechanism.coordinates.index(name) for name in names]
    whole = averaged(steps)
    return Balance(whole.terms, whole.values[:, rows], whole.doubt[rows]), names


def _toward(slopes: Complex, forces: Complex) -> Array:
    """Forces (places, N) along the coordinates, (n, N)."""
    return np.asarray(np.einsum("bnN,bN->nN", slopes.conj(), forces).real)


def _contacts(steps: Steps, Jn: Array, Jt: Array) -> dict[str, Array]:
    h = steps.lengths
    return {
        "normal": h * np.einsum("pnN,pN->nN", Jn, steps.normal),
        "friction": h * np.einsum("pnN,pN->nN", Jt, steps.tangential),
    }


def _pinned(steps: Steps, slopes: Complex) -> Array:
    x, y = steps.pins
    return _toward(slopes, x + 1j * y)


def _users(steps: Steps) -> Array:
    """The user's forces on their places along the way."""
    pushes = steps.model.parts.pushes
    total = pushes.rows.T @ steps.last.laws[2]
    if pushes.bodies:
        slopes = steps.mean(steps.inside.pose.points(pushes.places).slopes)
        total = total + _toward(slopes, pushed(steps))
    return np.asarray(total)
