"""Where the energy goes in every step of links in space."""

from collections.abc import Iterator

import numpy as np

from schemas.expressions import Tree, names_in
from schemas.urdf import Urdf
from solver.certificate.energies import SHORT, Energies
from solver.certificate.spatial_chords import spatial_chords
from solver.certificate.spatial_steps import SpatialSteps
from solver.numeric import Array
from solver.simulation.spatial_instant import SpatialInstant


def spatial_energies(steps: SpatialSteps) -> Energies:
    """All works and losses, as `solver.certificate.energies.step_energies` has them.

    A contact's work is its force times the true displacement of the touching matter over the step.
    """
    moved, stops = steps.moved, steps.stops
    n = len(steps.ends)
    driven, passive = _users(steps)
    kinetic, dissipation = _kinetic(steps) if steps.faithful else _at_ends(steps)
    system, told = steps.model.system, steps.published
    rows = [system.coordinates.index(joint) for joint in system.motor_joints]
    return Energies(
        kinetic=kinetic,
        gravity=steps.first.potential - steps.last.potential,
        springs=np.zeros(n),
        damping=np.sum(damped(steps) * moved, axis=0),
        motors=told.u[: len(rows)] * moved[rows],
        driven=driven,
        passive=passive,
        normal=steps.normal * np.diff(steps.gaps),
        friction=np.sum(steps.tangential * steps.slid, axis=0),
        stops=stops.efforts * (stops.slopes @ moved),
        pins=np.zeros((0, n)),
        dissipation=dissipation,
    )


def _kinetic(steps: SpatialSteps) -> tuple[Array, Array]:
    """The change of that of the chords, and that of their jumps."""
    links = spatial_chords(steps)
    change = sum((one.energy(one.after) - one.energy(one.before) for one in links), np.zeros(1))
    return change, sum((one.energy(one.jumps) for one in links), np.zeros(1))


def _at_ends(steps: SpatialSteps) -> tuple[Array, Array]:
    """By the velocities at the ends of steps: backward Euler's, which keep no books of energy."""
    change = steps.chords - steps.before
    lost = np.einsum("iN,Nij,jN->N", change, steps.last.mass, change) / 2
    return steps.last.kinetic - steps.first.kinetic, lost


def spatial_scale(steps: SpatialSteps, energies: Energies) -> float:
    """What energies are compared with, J: the weight over a length of the system.

    Without gravity, the work of the actuators; where they do none, the largest kinetic energy.
    """
    if np.any(steps.model.numbers.gravity):
        return steps.weight * _length(steps)
    work = float(energies.actuators.sum())
    return work if work > 0 else max(float(np.max(steps.knots.kinetic)), 1e-9)


def _length(steps: SpatialSteps) -> float:
    """How far places of the system are from its centre of mass, or that goes: the larger one, m."""
    at = steps.knots
    places = [frame.place for frame in (*at.frames.values(), *at.centres.values())]
    far = max(float(np.max(np.linalg.norm(place - at.com, axis=1))) for place in places)
    far += max(steps.model.numbers.radii.values(), default=0.0)
    way = float(np.max(np.linalg.norm(at.com - at.com[0], axis=1)))
    return max(far, way, SHORT)


def damped(steps: SpatialSteps) -> Array:
    """What the damping of joints pushes with, N or N m, (n, N)."""
    system, total = steps.model.system, np.zeros_like(steps.moved)
    for one in system.carriages:
        for step in one.steps if one.damping else ():
            row = system.coordinates.index(step.coordinates[0])
            total[row] -= one.damping * step.factor**2 * steps.chords[row]
    return total


def _users(steps: SpatialSteps) -> tuple[Array, Array]:
    """What the user's forces do, those with controls in them and the others."""
    system = steps.model.system
    driven, passive = np.zeros(len(steps.ends)), np.zeros(len(steps.ends))
    for name, force in users(steps):
        way = _place(steps.last, steps, name) - _place(steps.first, steps, name)
        work = np.einsum("Nk,Nk->N", force, way)
        if _controlled(system, system.forces[name].value.tree):
            driven += work
        else:
            passive += work
    return driven, passive


def users(steps: SpatialSteps) -> Iterator[tuple[str, Array]]:
    """The user's forces, N, in the world's axes, (N, 3), as they are at the end of a step."""
    system, at = steps.model.system, steps.last
    for (name, one), value in zip(system.forces.items(), at.pushing, strict=True):
        along = np.broadcast_to(steps.model.numbers.directions[name], (len(at.t), 3))
        if one.frame == "link":
            along = np.einsum("Nij,Nj->Ni", at.frames[one.link].axes, along)
        yield name, along * value[:, None]


def _place(at: SpatialInstant, steps: SpatialSteps, name: str) -> Array:
    force = steps.model.system.forces[name]
    return at.frames[force.link].shifted(steps.model.numbers.places[name]).place


def _controlled(system: Urdf, tree: Tree) -> bool:
    """Whether a control enters an expression."""
    pending, seen = [tree], set[str]()
    while pending:
        for name in {one.name for one in names_in(pending.pop())} - seen:
            seen.add(name)
            if name in system.define:
                pending.append(system.define[name].tree)
    return not seen.isdisjoint(system.control_names)
