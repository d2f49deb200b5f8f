"""Ends of a system in space that are inside of the ground, where the whole pose is given."""

from collections.abc import Iterator

import numpy as np

from schemas import resolve
from schemas.errors import Issue
from schemas.expressions import Name, derivative
from schemas.phases import Phase
from schemas.pointers import pointer
from schemas.urdf import Urdf
from solver.lowering.derivations import Derivations
from solver.mechanics.spatial import spatial_equations
from solver.numeric.tape import Array, Scope, record
from solver.poses.stand import INSIDE, VERBS

_UP = "base.z"


def sunk(phase: Phase, index: int, system: Urdf) -> Iterator[Issue]:
    """An issue for each end of which a contact is inside of the ground; with what lifts it out."""
    poses = {end: _pose(phase, end, system) for end in VERBS}
    given = {end: pose for end, pose in poses.items() if pose is not None}
    if not (given and system.contacts):
        return
    gaps = _gaps(system, np.array(list(given.values())).T)
    for (end, pose), column in zip(given.items(), gaps.T, strict=True):
        worst = int(np.argmin(column))
        depth = -float(column[worst])
        if depth > INSIDE:
            name = list(system.contacts)[worst]
            yield Issue(
                pointer("phases", index, end),
                f"'{name}' {VERBS[end]} {depth:.4g} m inside of the ground",
                _lifted(system, pose, depth),
            )


def _lifted(system: Urdf, pose: Array, depth: float) -> str:
    if _UP not in system.coordinates:
        return "move a joint so that it is above the ground, or lower 'ground'"
    height = pose[system.coordinates.index(_UP)] + depth
    return f"the same pose is clear at {_UP} = {height:.7g}"


def _pose(phase: Phase, end: str, system: Urdf) -> Array | None:
    """The coordinates at an end, where all of them are fixed there."""
    constants = resolve.parameters(system)
    bounds = [getattr(phase, end).get(name) for name in system.coordinates]
    limits = np.array([resolve.interval(bound, constants) for bound in bounds])
    return limits[:, 0] if bool(np.all(limits[:, 0] == limits[:, 1])) else None


def _gaps(system: Urdf, poses: Array) -> Array:
    """Of every contact at some poses (coordinates, k), shape (contacts, k)."""
    equations = spatial_equations(system.model_copy(update={"forces": {}, "mode": {}}))
    names = [f"contact.{name}.gap" for name in system.contacts]
    inputs = list(system.coordinates)
    rest = [derivative(name, order) for name in inputs for order in (1, 2)]
    numbers = {**resolve.parameters(system), **dict.fromkeys([*rest, "t"], 0.0)}
    known = {*inputs, *numbers}
    derivations = Derivations(equations.trees, numbers, (), known.__contains__)
    derivations.demand(names)
    scope = Scope(inputs, numbers, derivations.definitions(names))
    return record([Name(name) for name in names], scope)(list(poses), poses.shape[1:])
