"""The balance of momentum over a step, as rows: what a discrete-gradient step must meet."""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from schemas.expressions import Call, Number, Tree, derivative, names_in
from solver.discrete.chord import Chord, Column
from solver.discrete.norms import without_norms
from solver.discrete.slopes import Slopes
from solver.discrete.spins import grown, turning
from solver.expressions import SX, evaluate
from solver.lowering.derivations import Derivations
from solver.mechanics.principle import Coil, Principle
from solver.mechanics.trees import less, plus, square, times

_WIDTH = 1e-4  # m or rad
_FAINT = 1e-9  # N: for tendons that are dampers only


@dataclass(frozen=True, slots=True)
class Step:
    """A step in symbols, from state 0 to state 1; the rows ``q1 = q0 + h v1`` are the caller's.

    Attributes
    ----------
    q0, v0, q1, v1
        In the order of ``Principle.coordinates``.
    h, h_before
        Lengths of this step and of the one before, s; of none before it 0: then ``v0`` is a
        velocity at ``q0``, else that of the chord from ``q0 - h_before v0``.
    known
        Parameters, statics, controls and time ``t`` by name, as of the step's end.
    """

    q0: Column
    v0: Column
    q1: Column
    v1: Column
    h: SX
    h_before: SX
    known: Mapping[str, SX]


@dataclass(frozen=True, slots=True)
class StepRows:
    """What a step must meet, and what it loses.

    Attributes
    ----------
    momentum
        (n_q,), N s or N m s; zero where the step is in balance.
    slips
        (n_pairs,), m/s, in the order of ``Principle.pairs``.
    dissipation
        The numerical one of the step, ``1/2 sum(m |dV|^2 + dw I dw)``, J; plastic losses of
        contacts that close are part of it.
    """

    momentum: SX
    slips: SX
    dissipation: SX


def step_rows(principle: Principle, step: Step) -> StepRows:
    """The balance over a step: every force acts along the exact change of what it moves.

    See docs/theory.md, "The discrete-gradient backward Euler".
    """
    q0, v0, q1, v1 = step.q0, step.v0, step.q1, step.v1
    names = range(len(principle.coordinates))
    earlier = [q0[i] - step.h_before * v0[i] for i in names]
    now = _slopes(principle, (q0, q1, v1), step.known)
    before = _slopes(principle, (earlier, q0, v0), step.known)
    end = _End(principle, step)
    jumps = _jumps(principle, now, before, end)
    forces = [(chord, mass * jump) for chord, mass, jump in jumps]
    turns = [turning(one, now, before) for one in principle.spins]
    spins = [one for one in turns if one is not None]
    forces += [pull for pulls, _ in spins for pull in pulls]
    forces += [(chord, -step.h * force) for chord, force in _efforts(principle, now, end)]
    slips = [_slip(principle, now, i) for i in range(len(principle.slides))]
    for slide, found in zip(principle.slides, slips, strict=True):
        push = step.h * end(slide.effort)
        forces += [(chord, -factor * push) for chord, factor in found]
    return StepRows(
        without_norms(principle, (q0, q1), now.pull(forces)),
        ca.vertcat(SX(0, 1), *(sum((f * c.rate for c, f in one), SX(0)) for one in slips)),
        sum((0.5 * mass * jump * jump for _, mass, jump in jumps), SX(0))
        + sum((lost for _, lost in spins), SX(0)),
    )


def _slopes(
    principle: Principle, columns: tuple[Column, Column, Column], known: Mapping[str, SX]
) -> Slopes:
    before, after, rate = columns
    leaves = {
        name: (SX(before[i]), SX(after[i]), SX(rate[i]))
        for i, name in enumerate(principle.coordinates)
    }
    return Slopes(leaves, principle.definitions, known)


def _jumps(
    principle: Principle, now: Slopes, before: Slopes, end: "_End"
) -> list[tuple[Chord, SX, SX]]:
    """What is inert, its mass or inertia, and by how much its velocity jumps at the step's start.

    Gravity is not among them: it is a force.
    """
    found, inert = [], list[tuple[Tree, Tree]]()
    for body in principle.bodies:
        inert += [*((place, body.mass) for place in body.centre), (body.angle, body.inertia)]
    for tree, mass in inert:
        chord = now.of(tree)
        if chord.varies:
            found.append((chord, end(mass), chord.rate - before.of(tree).rate))
    return found


def _efforts(principle: Principle, now: Slopes, end: "_End") -> list[tuple[Chord, SX]]:
    """Forces, each with what it moves."""
    found = [(now.of(push.along), end(push.effort)) for push in principle.pushes]
    for body in principle.bodies:
        for place, gravity in zip(body.centre, principle.gravity, strict=True):
            found.append((now.of(place), end(times(body.mass, gravity))))
    for spring in principle.springs:
        length = now.of(spring.length)
        engaged = end(spring.engaged)
        found.append((now.of(_energy(spring)), -engaged))
        if spring.damping != Number(0.0):
            found.append((length, engaged * _damped(spring, length, end)))
    return found


def _energy(spring: Coil) -> Tree:
    """``k/2 (z - rest)^2``; of a tendon with the stretch where that is positive."""
    stretch = less(spring.length, spring.rest)
    if spring.pulling_only:
        stretch = _taut(stretch)
    return times(Number(0.5), spring.stiffness, square(stretch))


def _taut(stretch: Tree) -> Tree:
    """``max(s, 0)``, rounded over a width of 0.1 mm: ``(s + sqrt(s^2 + w^2)) / 2``."""
    rounded = Call("sqrt", (plus(square(stretch), Number(_WIDTH**2)),))
    return times(Number(0.5), plus(stretch, rounded))


def _damped(spring: Coil, length: Chord, end: "_End") -> SX:
    """What a damper adds to the force; with a tendon's spring it never pushes.

    A tendon's law is ``s(e - c dz/dt)`` with ``e = k (rest - z)`` at the mean length and s the
    lesser of its argument and 0, rounded; what it adds to ``s(e)`` is against the motion.
    """
    brake = -end(spring.damping) * length.rate
    if not spring.pulling_only:
        return brake
    stiffness = end(spring.stiffness)
    spare = stiffness * (end(spring.rest) - length.mean)
    return _pull(spare + brake, stiffness) - _pull(spare, stiffness)


def _pull(force: SX, stiffness: SX) -> SX:
    """A tendon's force, which is never positive, where an unclipped spring's is given."""
    wide = stiffness * _WIDTH + _FAINT
    size = ca.sqrt(force * force + wide * wide)
    return -((size - force) ** 2) / (4 * size)


def _slip(principle: Principle, now: Slopes, number: int) -> list[tuple[Chord, SX]]:
    """What moves a pair along its tangent, each with its mean factor over the step."""
    slide = principle.slides[number]
    found = [(now.of(moved), now.of(factor).mean) for factor, moved in slide.terms]
    if slide.rolls:
        angle = grown([now.of(entry) for entry in slide.axes])
        found += [(now.of(moved), angle * now.of(factor).mean) for factor, moved in slide.rolls]
    return [(moved, factor) for moved, factor in found if moved.varies]


class _End:
    """Trees at the end of the step, where velocities are those of the step."""

    def __init__(self, principle: Principle, step: Step) -> None:
        self._known, definitions = step.known, principle.definitions
        self._scope = {name: SX(step.q1[i]) for i, name in enumerate(principle.coordinates)}
        for i, name in enumerate(principle.coordinates):
            self._scope[derivative(name)] = SX(step.v1[i])
        given = {*step.known} - {*definitions, *self._scope}
        leaves = given | {*self._scope}
        constants = given - {"t", *principle.controls}
        self._derived = Derivations(definitions, {}, constants, leaves.__contains__)

    def __call__(self, tree: Tree) -> SX:
        names = [name.name for name in names_in(tree)]
        self._derived.demand(names)
        for name, meaning in self._derived.definitions(names).items():
            if name not in self._scope:
                self._scope[name] = self._evaluate(meaning)
        return self._evaluate(tree)

    def _evaluate(self, tree: Tree) -> SX:
        scope, known = self._scope, self._known
        names = {name.name for name in names_in(tree)}
        return evaluate(tree, {n: scope[n] if n in scope else known[n] for n in names})
