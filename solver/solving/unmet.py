"""Which constraints cannot be met: the ones that give way where all but the dynamics may."""

import numpy as np
from numpy.typing import NDArray

from schemas.problem import SolverSettings
from solver.backends import Backend, NlpStatus, Watch
from solver.nlp.elastic import elastic
from solver.nlp.program import Program
from solver.nlp.residuals import RowResidual, ranked_residuals
from solver.nlp.scaling import Scaling
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOTION = ("defect", "dynamics", "integral")
"""Rows that define the motion, by the first word of their names."""

_CONTACTS, _WRITTEN = ("contact.", "limit.", "#relaxation"), 2
"""How names of steps through contact begin, and the words of a row that a user wrote."""

_TIMES = ("start time", "end time")

_MET = 1e-5  # relative violation that an interior-point solver leaves where a constraint is met
_SETTLED = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE)


def unmet(
    backend: Backend,
    settings: SolverSettings,
    watch: Watch,
    program: Program,
    scaling: Scaling,
    task: NlpTask,
) -> list[RowResidual] | None:
    """What stays violated, the worst first, where the sum of violations is least.

    All but the dynamics and the start give way: bounds, ends, path and boundary constraints. If
    that has no solution, all rows do, within the bounds. Empty where all can be met, so
    that another guess may do; None where it was not found out, as at the deadline.

    Where steps go through contact, it is the friction cones alone that give way first: if that is
    enough, friction is what is missing.
    """
    every, none = np.ones(program.rows, dtype=bool), np.zeros(len(task.start), dtype=bool)
    cones = _cones(program)
    first = [(cones, none)] if cones.any() else []
    for rows, bounds in (*first, limits_of(program), (every, none)):
        relaxed = elastic(task, rows, bounds)
        if backend.refusal(relaxed.task):
            return None
        outcome = backend.solve(relaxed.task, settings, watch, warm=False)
        if outcome.status in _SETTLED:
            z = relaxed.point(outcome.point.z)
            return _violated(program, scaling, task, z)
        if outcome.status in (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT):
            return None
    return None


def limits_of(program: Program) -> tuple[Mask, Mask]:
    """Rows (m,) and variables (n,) whose limits are no part of the dynamics, nor of the start."""
    labels = program.labels()
    motion = np.array([label.name.split(" ")[0] in _MOTION for label in labels], dtype=bool)
    return ~(motion | _laws(program)), ~(_at_start(program) | _of_contacts(program))


def _laws(program: Program) -> Mask:
    """Rows (m,) of contacts that steps go through: users write no names of several words."""
    if not _of_contacts(program).any():
        return np.zeros(program.rows, dtype=bool)
    words = (label.name.split(" ") for label in program.labels())
    return np.array([one[0] == "path" and len(one) > _WRITTEN for one in words], dtype=bool)


def _cones(program: Program) -> Mask:
    """Those of them that are friction cones."""
    named = [label.name.endswith(" cone") for label in program.labels()]
    cones: Mask = _laws(program) & np.array(named, dtype=bool)
    return cones


def _of_contacts(program: Program) -> Mask:
    """Variables (n,) of our own along steps through contact, their relaxation, their times."""
    ours = np.zeros(program.variables.size, dtype=bool)
    for block in program.variables.blocks:
        for name, indices in zip(block.names, block.indices, strict=True):
            ours[indices] |= "#" in name and name.startswith(_CONTACTS)
    if ours.any():  # a motion of no length would meet most of what it is asked
        for block in program.variables.blocks:
            for name, indices in zip(block.names, block.indices, strict=True):
                ours[indices] |= name in _TIMES
    return ours


def _at_start(program: Program) -> Mask:
    """Variables (n,) at the start of a phase: what is given there is seldom the mistake."""
    start = np.zeros(program.variables.size, dtype=bool)
    for block in program.variables.blocks:
        start[block.indices[:, block.fractions == 0.0]] = True
    return start


def _violated(program: Program, scaling: Scaling, task: NlpTask, z: Array) -> list[RowResidual]:
    rows = task.nlp.evaluate(z)[1].full().ravel()
    found = ranked_residuals(program, scaling, z * scaling.columns, rows * scaling.rows)
    laws = _laws(program) & ~_cones(program)  # pairs are judged by the relaxation, not by rows
    kept = {label.name for label, law in zip(program.labels(), laws, strict=True) if law}
    return [one for one in found if one.relative > _MET and one.name not in kept]
