"""Whether a point is an optimum, as far as numbers of its size can tell.

Solvers compare the gradient of the Lagrangian with an absolute tolerance. Where its terms are
large, as with fourth derivatives, round-off keeps it above that for ever, and a solve that has
long arrived ends as merely acceptable, or fails in its last step.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from solver.nlp.task import NlpTask

Array = NDArray[np.float64]

_AT = 1e-7  # scaled: how near to a limit a variable or row is held by it
_SOFT = 1e-11  # keeps dependent rows and flat directions from making the system singular


def stationary(
    task: NlpTask, z: Array, row_multipliers: Array, bound_multipliers: Array, tolerance: float
) -> bool:
    """Whether the Lagrangian's gradient vanishes, or is worth nothing.

    Component by component abs(g + J' l + b) <= tolerance * max(1, abs(g) + abs(J)' abs(l) +
    abs(b)); or the Newton step that would make it vanish, along the active constraints, promises
    to change the objective f by no more than tolerance * (1 + abs(f)).
    """
    objective, slope = task.nlp.gradient(z, [])
    rows, matrix = task.nlp.jacobian(z, [])
    slopes, jacobian = slope.full().ravel(), matrix.sparse().tocsc()
    rest = slopes + jacobian.T @ row_multipliers + bound_multipliers
    terms = np.abs(slopes) + abs(jacobian).T @ np.abs(row_multipliers) + np.abs(bound_multipliers)
    if not np.isfinite(rest).all():
        return False
    if np.all(np.abs(rest) <= tolerance * np.maximum(1.0, terms)):
        return True
    free = np.flatnonzero((z - task.lower > _AT) & (task.upper - z > _AT))
    values = rows.full().ravel()
    held = np.flatnonzero((values - task.row_lower <= _AT) | (task.row_upper - values <= _AT))
    upper = task.nlp.hessian(z, [], 1.0, row_multipliers).sparse().tocsc()
    whole = upper + sparse.triu(upper, 1).T
    promised = _promise(whole[free][:, free], jacobian[held][:, free], rest[free])
    return promised <= tolerance * (1 + abs(float(objective)))


def _promise(hessian: sparse.csc_matrix, jacobian: sparse.csc_matrix, rest: Array) -> float:
    """By how much the Newton step promises to change the objective; infinite without a step."""
    count = jacobian.shape[0]
    # Without them a model without curvature makes a structurally singular system, at which
    # SuperLU may read beyond its memory.
    soft = sparse.diags([_SOFT] * len(rest) + [-_SOFT] * count)
    system = (sparse.bmat([[hessian, jacobian.T], [jacobian, None]]) + soft).tocsc()
    try:
        step = splu(system).solve(np.concatenate([-rest, np.zeros(count)]))[: len(rest)]
    except RuntimeError:  # singular
        return np.inf
    change = abs(float(rest @ step))
    return change if np.isfinite(change) else np.inf
