"""Forces that the motion does not determine: the second one along the ground under a rigid foot.

Where what is held depends on itself, the forces that hold it are not unique, and their equations
singular. The rows are taken in order (normals, tangents, loops), each made orthogonal to those
before it in the metric of the inverse mass matrix; what is left of a dependent one is nothing. It
is dropped, and its force is a control from then on, drawn to zero by a small cost.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from schemas.expressions import Call, Expression, Name, Number, Tree
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.problem import Objective, Problem
from solver.model import read_static
from solver.numeric.tape import Array
from solver.poses.search import Search
from solver.poses.tapes import Tapes

COST = 1e-6
"""Of the square of a loose force, per second."""

_POSES, _DEPENDENT = 3, 1e-7
_INTEGRAL = "#loose"


def loosened(problem: Problem) -> Problem:
    """The problem with loose forces as controls, and their cost in the objective."""
    statics = {name: read_static(name, one).guess for name, one in problem.static.items()}
    phases = [_loosened(phase, statics) for phase in problem.phases]
    changed = [new for new, old in zip(phases, problem.phases, strict=True) if new is not old]
    if not changed:
        return problem
    terms: list[Tree] = [Name(f"{phase.name}.{_INTEGRAL}") for phase in changed]
    if problem.objective is not None:
        terms.insert(0, problem.objective.minimize.tree)
    text = problem.objective.minimize.text if problem.objective else "0"
    tree = Call("+", tuple(terms)) if len(terms) > 1 else terms[0]
    objective = Objective.model_construct(minimize=Expression(text, tree))
    return problem.model_copy(update={"phases": phases, "objective": objective})


def _loosened(phase: Phase, statics: Mapping[str, float]) -> Phase:
    system = phase.system
    if not isinstance(system, Mechanism) or system.loose:
        return phase
    loose = loose_forces(system, statics)
    if not loose:
        return phase
    squares = tuple(Call("^", (Name(name), Number(2.0))) for name in loose)
    whole = Call("+", squares) if len(squares) > 1 else squares[0]
    cost = Expression("loose forces", Call("*", (Number(COST), whole)))
    return phase.model_copy(
        update={
            "system": system.model_copy(update={"loose": loose}),
            "integrals": {**phase.integrals, _INTEGRAL: cost},
        }
    )


def loose_forces(system: Mechanism, statics: Mapping[str, float]) -> list[str]:
    """The forces whose rows depend on those before them, wherever the mechanism may be."""
    if not (system.mode or system.loops):
        return []
    tapes = Tapes(system, statics)
    held = tapes.equations.held
    poses = _poses(tapes)
    weights = tapes.masses(poses)
    if len(held) == 1 or not _definite(weights):  # `check_inertias` says what is wrong with them
        return []
    rates = tapes.tape([row.rate for row in held])
    dependent = [
        _dependent(tapes.rows(rates, pose), weight)
        for pose, weight in zip(poses, weights, strict=True)
    ]
    always = np.all(dependent, axis=0)
    return [row.force for row, idle in zip(held, always, strict=True) if idle]


def _definite(matrices: Array) -> bool:
    return bool(np.isfinite(matrices).all() and np.linalg.eigvalsh(matrices).min() > 0)


def _poses(tapes: Tapes) -> Array:
    """Poses at which what is held is in place, (poses, coordinates)."""
    held = tapes.equations.held
    anchored = [row.place for row in held if row.kind != "tangential" and row.place is not None]
    count = len(tapes.system.coordinates)
    starts = np.random.default_rng(0).uniform(-1, 1, (_POSES, count))
    zeros, open_box = np.zeros(len(anchored)), np.full(count, np.inf)
    search = Search(tapes, tapes.tape(anchored), zeros, zeros)
    return np.array([search.best((-open_box, open_box), start).pose for start in starts])


def _dependent(rows: Array, mass: Array) -> NDArray[np.bool_]:
    """Which rows depend on those before them, by Gram and Schmidt in the inverse mass metric."""
    white = np.linalg.solve(np.linalg.cholesky(mass), rows.T).T
    kept: list[Array] = []
    found = []
    for row in white:
        left = row.copy()
        for _ in range(2):
            for one in kept:
                left = left - (left @ one) * one
        size = np.linalg.norm(left)
        idle = bool(size <= _DEPENDENT * max(float(np.linalg.norm(row)), 1e-300))
        found.append(idle)
        if not idle:
            kept.append(left / size)
    return np.array(found)
