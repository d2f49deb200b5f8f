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
    """
    limits, every = limits_of(program), np.ones(program.rows, dtype=bool)
    for rows, bounds in (limits, (every, np.zeros(len(task.start), dtype=bool))):
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
    return ~motion, ~_at_start(program)


def _at_start(program: Program) -> Mask:
    """Variables (n,) at the start of a phase: what is given there is seldom the mistake."""
    start = np.zeros(program.variables.size, dtype=bool)
    for block in program.variables.blocks:
        start[block.indices[:, block.fractions == 0.0]] = True
    return start


def _violated(program: Program, scaling: Scaling, task: NlpTask, z: Array) -> list[RowResidual]:
    rows = task.nlp.evaluate(z)[1].full().ravel()
    found = ranked_residuals(program, scaling, z * scaling.columns, rows * scaling.rows)
    return [residual for residual in found if residual.relative > _MET]
