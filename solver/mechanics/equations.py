"""A mechanism's motion as equations: inverse dynamics over names, one residual a coordinate."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from schemas.expressions import Name, Tree, derivative
from schemas.mechanisms import Mechanism
from solver.mechanics.actuation import Actuation
from solver.mechanics.frames import Frames, rates
from solver.mechanics.held import Held, held_rows, pin_loads
from solver.mechanics.loads import Balance, Load, opposite
from solver.mechanics.series import centres, places, whole
from solver.mechanics.touching import Touch, tangential_force, touches
from solver.mechanics.trees import ORIGIN, ZERO, apart, minus, scaled, times, vector


@dataclass(frozen=True, slots=True)
class Equations:
    """What a mechanism says about its motion.

    Attributes
    ----------
    trees
        Definitions of every name of ``mechanism.defined``, of shared pieces under names with a
        ``#``, and of the rows.
    rows
        Names of the residuals: dynamics of every coordinate, then the accelerations of what is
        held.
    forces
        Names of forces that are found together with the accelerations, one a held row.
    held
        What is held along the phase: contacts that touch, loops; but what other rows imply, whose
        forces are ``mechanism.loose``.
    """

    trees: dict[str, Tree]
    rows: tuple[str, ...]
    forces: tuple[str, ...]
    held: tuple[Held, ...]


def equations_of(mechanism: Mechanism) -> Equations:
    """The equations of motion of a checked mechanism."""
    frames = Frames.of(mechanism)
    actuation = Actuation.of(frames)
    touching = touches(frames)
    held = held_rows(frames, touching)
    balance = Balance(frames)
    balance.add(_inertial(frames))
    balance.add(opposite(load) for load in (*actuation.loads, *_holding(mechanism, touching)))
    efforts = {joint: minus(effort) for joint, effort in actuation.efforts.items()}
    dynamics = balance.generalized(efforts)
    tied = tuple(row for row in held if row.force not in mechanism.loose)
    rows = {f"#dynamics {name}": tree for name, tree in dynamics.items()}
    rows |= {f"#held acceleration {row.name}": Name(row.acceleration) for row in tied}
    trees = places(frames) | whole(frames, actuation.energies) | actuation.trees
    trees |= _given_forces(mechanism, touching) | frames.trees | balance.trees | rows
    return Equations(trees, tuple(rows), tuple(row.force for row in tied), tied)


def _holding(mechanism: Mechanism, touching: Mapping[str, Touch]) -> Iterator[Load]:
    """The forces of contacts that touch, and of loops."""
    for name in mechanism.mode:
        yield from touching[name].loads(*_forces(name))
    for name, loop in mechanism.loops.items():
        yield from pin_loads(name, loop)


def _given_forces(mechanism: Mechanism, touching: Mapping[str, Touch]) -> dict[str, Tree]:
    """Forces that are known: none of open contacts, and those that sliding gives."""
    trees: dict[str, Tree] = {}
    for name, touch in touching.items():
        normal, tangential = _forces(name)
        if name not in mechanism.mode:
            trees |= {normal.name: ZERO, tangential.name: ZERO}
            continue
        given = tangential_force(mechanism.mode[name], touch)
        if given is not None:
            trees[tangential.name] = given
    return trees


def _forces(pair: str) -> tuple[Name, Name]:
    return Name(f"contact.{pair}.normal"), Name(f"contact.{pair}.tangential")


def _inertial(frames: Frames) -> Iterator[Load]:
    """What it takes to accelerate every body against gravity."""
    mechanism = frames.mechanism
    gravity = vector(mechanism.gravity)
    for name, middle in centres(frames).items():
        body = mechanism.bodies[name]
        along = apart(rates(middle, 2), gravity)
        push = ORIGIN if body.mass is None else scaled(body.mass.tree, along)
        shared = frames.shared(f"{name}#ix", push[0]), frames.shared(f"{name}#iy", push[1])
        turning = Name(derivative(f"{name}.angle", 2))
        couple = ZERO if body.inertia is None else times(body.inertia.tree, turning)
        yield Load(name, vector(body.com), shared, couple)
