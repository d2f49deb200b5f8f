"""Where the energy goes in every step: what each force does over the true displacement."""

from dataclasses import dataclass

import numpy as np

from schemas.expressions import Tree, names_in
from solver.certificate.steps import Steps
from solver.numeric import Array
from solver.simulation.kinematics import Complex

WIDTH = 1e-4
"""Over which tendons get taut, m or rad."""

SHORT = 1e-3
"""The least length that energies are compared by, m: a point that rests has none."""

FAINT = 1e-9
"""And dampers that only pull, N."""


@dataclass(frozen=True, slots=True)
class Energies:
    """J, of each of the N steps.

    Attributes
    ----------
    kinetic
        Its change, by chord velocities: straight from place to place, (N,).
    gravity, springs, damping
        What they do, (N,).
    motors, driven, passive
        Of the motors (motors, N); of the user's forces that controls enter, and of others, (N,).
    normal, friction
        Of the contacts, (pairs, N).
    stops, pins
        Of the joints' limits (stops, N) and of the loops (loops, N).
    dissipation
        What the step itself takes, ``1/2 sum(m |dV|^2 + I dw^2)``, (N,); in steps in which a
        contact closes part of it is the plastic loss.
    """

    kinetic: Array
    gravity: Array
    springs: Array
    damping: Array
    motors: Array
    driven: Array
    passive: Array
    normal: Array
    friction: Array
    stops: Array
    pins: Array
    dissipation: Array

    @property
    def actuators(self) -> Array:
        """What motors and the user's controls do in each step, both signs positive, (N,)."""
        return np.asarray(np.abs(self.motors).sum(axis=0) + np.abs(self.driven))

    @property
    def left(self) -> Array:
        """What the books leave open, (N,)."""
        single = self.gravity + self.springs + self.damping + self.driven + self.passive
        rows = (self.motors, self.normal, self.friction, self.stops, self.pins)
        work = single + sum(row.sum(axis=0) for row in rows)
        return np.asarray(self.kinetic + self.dissipation - work)


@dataclass(frozen=True, slots=True)
class Chords:
    """The bodies' own velocities from knot to knot, and those of the step before.

    ``after`` and ``before`` of the centres of mass, complex m/s (bodies, N); ``spins`` and
    ``spins_before``, rad/s.
    """

    after: Complex
    before: Complex
    spins: Array
    spins_before: Array


def chords(steps: Steps) -> Chords:
    """Where a phase is periodic its last step comes before the first; else the first velocities."""
    knots, turning = steps.knots, steps.model.parts.kinematics.turning[1:]
    after, spins = np.diff(knots.coms.z) / steps.lengths, turning @ steps.chords
    if steps.before is None or not steps.faithful:
        first, turned = knots.coms.rate[:, :1], knots.pose.spins[1:, :1]
    else:
        rows = list(steps.before)
        first, turned = after[rows, -1:], spins[rows, -1:]
    return Chords(
        after,
        np.concatenate([first, after[:, :-1]], axis=1),
        spins,
        np.concatenate([turned, spins[:, :-1]], axis=1),
    )


def step_energies(steps: Steps) -> Energies:
    """All works and losses.

    The work of a force over a step is the force, which does not change in it, times the true
    displacement of what it acts on along the straight way from knot to knot: the change of a gap,
    the way that the touching matter slips, the change of a joint.
    """
    parts, lengths, moved = steps.model.parts, steps.lengths, steps.moved
    V, stops = chords(steps), steps.stops
    axes = parts.axes.rows[[drive.axis for drive in parts.drives.values()]]
    spring, damper = tensions(steps)
    stretched = np.diff(steps.knots.stretch.length)
    driven, passive = _users(steps)
    x, y = steps.pins
    opened = np.diff(steps.knots.loops.z)
    return Energies(
        kinetic=_kinetic(steps, V.after, V.spins) - _kinetic(steps, V.before, V.spins_before),
        gravity=parts.masses @ (np.conj(parts.gravity) * V.after * lengths).real,
        springs=np.sum(spring * stretched, axis=0),
        damping=np.sum(damper * stretched, axis=0),
        motors=steps.last.motors * (axes @ moved),
        driven=driven,
        passive=passive,
        normal=steps.normal * np.diff(steps.gaps),
        friction=steps.tangential * steps.slid,
        stops=stops.efforts * (stops.slopes @ moved),
        pins=x * opened.real + y * opened.imag,
        dissipation=_kinetic(steps, V.after - V.before, V.spins - V.spins_before),
    )


def _kinetic(steps: Steps, V: Complex, spins: Array) -> Array:
    parts = steps.model.parts
    return np.asarray((parts.masses @ np.abs(V) ** 2 + parts.inertias @ spins**2) / 2)


def tensions(steps: Steps) -> tuple[Array, Array]:
    """The mean force of each spring along a step, without and of its damping, (springs, N).

    Those of tendons are never positive; see docs/theory.md, "Springs", for their law.
    """
    springs, laws = steps.model.parts.springs, steps.last.laws[0]
    stiffness, rest, damping, engaged = laws.transpose(1, 0, 2)
    stretch = steps.knots.stretch.length
    stretch = np.stack([stretch[:, :-1], stretch[:, 1:]]) - rest
    spare = -stiffness * stretch.mean(axis=0)
    force, damper = spare.copy(), -damping * (stretch[1] - stretch[0]) / steps.lengths
    some = list(springs.pulling)
    force[some] = -stiffness[some] * _taut(stretch[:, some])
    before = _pull(spare[some], stiffness[some])
    damper[some] = _pull((spare + damper)[some], stiffness[some]) - before
    return engaged * force, engaged * damper


def _taut(stretch: Array) -> Array:
    """The mean of ``p dp/ds`` over steps between two stretches (2, ...): change of ``p^2/2``.

    ``p(s) = (s + sqrt(s^2 + w^2)) / 2``; what is common to both roots is taken out by hand, so
    that it holds for steps of any size.
    """
    root = np.hypot(stretch, WIDTH)
    rounded = (stretch + root) / 2
    slope = (1 + stretch.sum(axis=0) / root.sum(axis=0)) / 2
    return np.asarray(rounded.mean(axis=0) * slope)


def _pull(force: Array, stiffness: Array) -> Array:
    """``-S``, a tendon's force where a spring that also pushes has ``force``, by S = k p dp/ds."""
    wide = stiffness * WIDTH + FAINT
    root = np.hypot(force, wide)
    return np.asarray(-((root - force) ** 2) / (4 * root))


def _users(steps: Steps) -> tuple[Array, Array]:
    """What the user's forces and torques do, those with controls in them and the others."""
    mechanism, pushes = steps.model.mechanism, steps.model.parts.pushes
    trees = [one.value.tree for one in mechanism.forces.values()]
    trees += [one.value.tree for one in mechanism.torques.values()]
    works = np.zeros((len(trees), len(steps.ends)))
    count = len(pushes.bodies)
    if count:
        places = pushes.places @ steps.knots.pose.features
        works[:count] = (pushed(steps).conj() * np.diff(places)).real
    works[count:] = steps.last.laws[2] * (pushes.rows @ steps.moved)
    ours = np.array([_controlled(steps, tree) for tree in trees], dtype=bool)
    return works[ours].sum(axis=0), works[~ours].sum(axis=0)


def pushed(steps: Steps) -> Complex:
    """The user's forces, N, in the world: as they are at the end of a step, (forces, N)."""
    pushes, at = steps.model.parts.pushes, steps.last
    return np.asarray(at.laws[1] * pushes.directions[:, None] * at.pose.turns[list(pushes.bodies)])


def _controlled(steps: Steps, tree: Tree) -> bool:
    """Whether a control enters an expression."""
    mechanism = steps.model.mechanism
    pending, seen = [tree], set[str]()
    while pending:
        for name in {one.name for one in names_in(pending.pop())} - seen:
            seen.add(name)
            if name in mechanism.define:
                pending.append(mechanism.define[name].tree)
    return not seen.isdisjoint(mechanism.control_names)


def scale(steps: Steps, energies: Energies) -> float:
    """What energies are compared with, J: the weight over a length of the mechanism.

    Without gravity, the work of the actuators; where they do none, the largest kinetic energy.
    """
    parts = steps.model.parts
    if abs(parts.gravity) > 0 and parts.masses.sum() > 0:
        return steps.weight * length(steps)
    V = chords(steps)
    work = float(energies.actuators.sum())
    return work if work > 0 else max(float(np.max(_kinetic(steps, V.before, V.spins_before))), 1e-9)


def length(steps: Steps) -> float:
    """A length of the motion, m: how far its parts are from their centre of mass, or that goes.

    The larger one: a single body may have no extent, and a machine may stay where it is.
    """
    parts, pose = steps.model.parts, steps.knots.pose
    places = np.array([*parts.coms, *parts.spots.values()])
    com = parts.masses @ (parts.coms @ pose.features) / parts.masses.sum()
    far = float(np.max(np.abs(places @ pose.features - com)))
    far += float(np.max(parts.touch.radii, initial=0.0))
    way = float(np.max(np.abs(com - com[0])))
    return max(far, way, SHORT)
