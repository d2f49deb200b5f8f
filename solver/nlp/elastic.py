"""Constraints that may be violated at a price: where no point meets all, which ones give way.

The elastic program of a task: minimize the sum of all violations, each a variable of its own,

    min  sum(p) + sum(n) + weight |z - start|^2 / 2
    s.t. lower <= rows(z) - p + n <= upper,  p, n >= 0,

an exact l1 penalty (Nocedal and Wright, section 17.2) without the objective. It is always
feasible. Where some point meets all constraints, its solution is one close to the start.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.nlp.assembly import Nlp
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Indices = NDArray[np.int_]
Mask = NDArray[np.bool_]

_NEAR = 1e-4  # weight of staying near the start: makes the solution unique where all are met


@dataclass(frozen=True, slots=True)
class Elastic:
    """The elastic task, and how to read its point: ``z`` are its first ``size`` variables."""

    task: NlpTask
    size: int

    def point(self, y: Array) -> Array:
        """The original variables at a point of the elastic task."""
        return y[: self.size]


@dataclass(frozen=True, slots=True)
class _Slacks:
    """Rows of the elastic task and their slacks: ``above`` and ``below`` are row numbers.

    ``bounds`` are variables whose limits have become rows, after the task's own.
    """

    bounds: Indices
    lower: Array
    upper: Array
    above: Indices
    below: Indices

    @property
    def count(self) -> int:
        """How many slacks there are."""
        return len(self.above) + len(self.below)

    def matrix(self) -> ca.DM:
        """What the slacks add to the rows, shape (rows, slacks)."""
        rows = np.concatenate([self.above, self.below])
        signs = np.repeat([-1.0, 1.0], [len(self.above), len(self.below)])
        columns = np.arange(self.count)
        return ca.DM.triplet(
            rows.tolist(), columns.tolist(), ca.DM(signs), len(self.lower), self.count
        )


def elastic(task: NlpTask, rows: Mask, bounds: Mask) -> Elastic:
    """Let some rows (m,) and the bounds of some variables (n,) give way."""
    slacks = _slacks(task, rows, bounds)
    start = task.start
    values = task.nlp.evaluate(start)[1].full().ravel()
    values = np.concatenate([values, start[slacks.bounds]])
    begin = [
        np.maximum(values[slacks.above] - slacks.upper[slacks.above], 0.0),
        np.maximum(slacks.lower[slacks.below] - values[slacks.below], 0.0),
    ]
    lower, upper = task.lower.copy(), task.upper.copy()
    lower[slacks.bounds], upper[slacks.bounds] = -np.inf, np.inf
    zero, open_end = np.zeros(slacks.count), np.full(slacks.count, np.inf)
    relaxed = NlpTask(
        nlp=_functions(task, slacks),
        start=np.concatenate([start, *begin]),
        lower=np.concatenate([lower, zero]),
        upper=np.concatenate([upper, open_end]),
        row_lower=slacks.lower,
        row_upper=slacks.upper,
    )
    return Elastic(relaxed, len(start))


def _slacks(task: NlpTask, rows: Mask, bounds: Mask) -> _Slacks:
    limited = np.isfinite(task.lower) | np.isfinite(task.upper)
    chosen = np.flatnonzero(bounds & limited)
    lower = np.concatenate([task.row_lower, task.lower[chosen]])
    upper = np.concatenate([task.row_upper, task.upper[chosen]])
    gives = np.concatenate([rows, np.ones(len(chosen), dtype=bool)])
    above, below = (np.flatnonzero(gives & np.isfinite(side)) for side in (upper, lower))
    return _Slacks(chosen, lower, upper, above, below)


def _functions(task: NlpTask, slacks: _Slacks) -> Nlp:
    """The task's functions with the slacks around them."""
    nlp, size, own = task.nlp, len(task.start), len(task.row_lower)
    y, none = ca.MX.sym("y", size + slacks.count), ca.MX.sym("p", 0)
    z, slack = ca.vertsplit(y, [0, size, size + slacks.count])
    added = slacks.matrix()
    picked = ca.DM(
        ca.Sparsity.triplet(
            len(slacks.bounds), size, list(range(len(slacks.bounds))), slacks.bounds.tolist()
        ),
        1.0,
    )

    def whole(values: ca.MX) -> ca.MX:
        return ca.vertcat(values, z[slacks.bounds.tolist()]) + ca.mtimes(added, slack)

    away = z - ca.DM(task.start)
    objective = ca.sum1(slack) + _NEAR / 2 * ca.dot(away, away)
    gradient = ca.vertcat(_NEAR * away, ca.DM.ones(slacks.count))
    values, jacobian = nlp.jacobian(z, none)
    steep = ca.horzcat(ca.vertcat(jacobian, picked), added)
    sigma, lam = ca.MX.sym("sigma"), ca.MX.sym("lam", own + len(slacks.bounds))
    curved = nlp.hessian(z, none, 0.0, lam[:own]) + _NEAR * sigma * ca.DM.eye(size)
    hessian = ca.diagcat(curved, ca.DM(slacks.count, slacks.count))
    rows = whole(nlp.evaluate(z)[1])
    return Nlp(
        symbols=y,
        objective=objective,
        rows=rows,
        gradient=ca.Function("gradient", [y, none], [objective, gradient]),
        jacobian=ca.Function("jacobian", [y, none], [whole(values), steep]),
        hessian=ca.Function("hessian", [y, none, sigma, lam], [hessian]),
        evaluate=ca.Function("evaluate", [y], [objective, rows]),
    )
