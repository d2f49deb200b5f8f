"""Drake's SNOPT as one more backend: our functions and slopes, handed over through callbacks.

Only for the comparison: it needs ``pydrake``, which the engine never does. Rows with constant
slopes are handed over as linear ones. The others go in parts, each with the variables that it
knows and with the places of its slopes: pydrake wants derivatives as dense matrices, and that of
the whole would be larger than all work of SNOPT.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from pydrake.autodiffutils import ExtractValue, InitializeAutoDiff
from pydrake.solvers import MathematicalProgram, SnoptSolver, SolverOptions

from schemas.problem import SolverSettings
from solver.backends import DEFAULT, Backend, NlpStatus, Outcome, Strategy, Watch
from solver.backends.plugin import Ended, conclude, iterate_at
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

STATUSES: Mapping[str, NlpStatus] = MappingProxyType(
    {
        "kSolutionFound": NlpStatus.OPTIMAL,
        "kInfeasibleConstraints": NlpStatus.INFEASIBLE,
        "kUnbounded": NlpStatus.UNBOUNDED,
        "kIterationLimit": NlpStatus.ITERATION_LIMIT,
        "kSolverSpecificError": NlpStatus.DIVERGED,
        "kInvalidInput": NlpStatus.INVALID_NUMBER,
        "kSolutionResultNotSet": NlpStatus.DIVERGED,
    }
)
"""What Drake returns -> the neutral status."""

_PART = 60  # rows
_LONG = 200  # variables of a row that is a part of its own: a sum over all steps
_UNLIMITED = 1_000_000


class Snopt(Backend):
    """SNOPT as Drake's wheel ships it, with room for as many superbasics as there are variables.

    ``inside`` adds up the processor seconds of the callbacks, what pydrake does around them left
    out. Its iterations are not told; evaluations of all functions and slopes stand for them.
    """

    name = "snopt"
    statuses = STATUSES

    def __init__(self) -> None:
        self.inside = 0.0

    def available(self) -> bool:
        """Whether Drake brings it."""
        return bool(SnoptSolver().available())

    def refusal(self, task: NlpTask) -> str:
        """It takes every program."""
        del task
        return ""

    def solve(
        self,
        task: NlpTask,
        settings: SolverSettings,
        watch: Watch,
        *,
        warm: bool,
        strategy: Strategy = DEFAULT,
    ) -> Outcome:
        """Solve; the start and the end are shown to the watch, SNOPT keeps the time by itself."""
        del warm, strategy
        watch.see(iterate_at(task, task.start))
        values = _Values(task)
        program = _program(task, values)
        values.evaluations, values.seconds = 0, 0.0
        began = time.perf_counter()
        options = _options(settings, watch, len(task.start))
        result = SnoptSolver().Solve(program, task.start, options)
        seconds = time.perf_counter() - began
        self.inside += values.seconds
        final = iterate_at(task, np.clip(result.get_x_val(), task.lower, task.upper))
        watch.see(final)
        raw = str(result.get_solution_result()).rpartition(".")[2]
        return conclude("SNOPT", Ended(raw, final, values.evaluations, seconds), STATUSES, watch)


def _options(settings: SolverSettings, watch: Watch, size: int) -> SolverOptions:
    options = SolverOptions()
    values: dict[str, Any] = {
        "Major iterations limit": settings.max_iterations,
        "Iterations limit": _UNLIMITED,
        "Superbasics limit": size + 1,
        "Major feasibility tolerance": 1e-8,
        "Major optimality tolerance": settings.tolerance,
        "Time limit": float(np.clip(watch.remaining(), 1.0, 1e6)),
    }
    for name, value in values.items():
        options.SetOption(SnoptSolver.id(), name, value)
    return options


class _Values:
    """Values and slopes at the last point that was asked for."""

    def __init__(self, task: NlpTask) -> None:
        self.task, self.seconds, self.evaluations = task, 0.0, 0
        self.z = np.full(len(task.start), np.nan)
        self.objective, self.gradient = 0.0, np.zeros(0)
        self.rows, self.slopes = np.zeros(0), scipy.sparse.csr_matrix((0, 0))

    def at(self, z: Array) -> None:
        """Evaluate, unless it is where we are."""
        if np.array_equal(z, self.z):
            return
        nlp, none = self.task.nlp, np.zeros((0, 1))
        objective, gradient = nlp.gradient(z, none)
        rows, slopes = nlp.jacobian(z, none)
        self.z = z.copy()
        self.objective, self.gradient = float(objective), gradient.full().ravel()
        self.rows, self.slopes = rows.full().ravel(), slopes.sparse().tocsr()
        self.evaluations += 1

    def timed(self, callback: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """A callback whose processor time counts."""

        def call(z: Any) -> Any:
            began = time.process_time()
            found = callback(z)
            self.seconds += time.process_time() - began
            return found

        return call

    def partly(self, places: Indices, values: Array) -> None:
        """The same, where some variables are told and the others are as they were."""
        z = self.z.copy()
        z[places] = values
        self.at(z)


def _program(task: NlpTask, values: _Values) -> MathematicalProgram:
    program = MathematicalProgram()
    z = program.NewContinuousVariables(len(task.start), "z")
    program.AddBoundingBoxConstraint(task.lower, task.upper, z)
    program.AddCost(values.timed(_cost(values)), vars=z)
    linear, pattern = _linear(task, values)
    if linear.any():
        values.at(task.start)
        a, some = values.slopes[linear], task.start
        offset = values.rows[linear] - a @ some
        limits = task.row_lower[linear] - offset, task.row_upper[linear] - offset
        program.AddLinearConstraint(A=a.tocsc(), lb=limits[0], ub=limits[1], vars=z)
    for rows in _parts(pattern, np.flatnonzero(~linear)):
        places = np.unique(pattern[rows].indices)
        callback = values.timed(_constraint(values, rows, places))
        limits = task.row_lower[rows], task.row_upper[rows]
        bound = program.AddConstraint(callback, *limits, z[places])
        local = pattern[rows][:, places].tocoo()
        bound.evaluator().SetGradientSparsityPattern(
            list(zip(local.row.tolist(), local.col.tolist(), strict=True))
        )
    return program


def _linear(task: NlpTask, values: _Values) -> tuple[NDArray[np.bool_], scipy.sparse.csr_matrix]:
    """Which rows have the same slopes at three points; and where slopes may be, as ones."""
    random, found = np.random.default_rng(0), []
    for _ in range(3):
        values.at(task.start + random.uniform(-0.1, 0.1, len(task.start)))
        found.append(values.slopes)
    pattern = task.nlp.jacobian.sparsity_out(1)
    ones = scipy.sparse.csc_matrix(
        (np.ones(pattern.nnz()), pattern.row(), pattern.colind()), pattern.shape
    ).tocsr()
    apart = sum(abs(one - found[0]).max(axis=1).toarray().ravel() for one in found[1:])
    return np.asarray(apart <= 1e-12), ones


def _parts(pattern: scipy.sparse.csr_matrix, rows: Indices) -> Iterator[Indices]:
    """Rows in parts that know few variables, in the order of the program: step by step."""
    counts = np.diff(pattern.indptr)
    long = rows[counts[rows] > _LONG]
    short = rows[counts[rows] <= _LONG]
    yield from (np.array([row]) for row in long)
    yield from (short[i : i + _PART] for i in range(0, len(short), _PART))


def _cost(values: _Values) -> Callable[[Any], Any]:
    def cost(z: Any) -> Any:
        if z.dtype != object:
            values.at(z)
            return values.objective
        values.at(ExtractValue(z).ravel())
        return InitializeAutoDiff([values.objective], values.gradient[None, :])[0, 0]

    return cost


def _constraint(values: _Values, rows: Indices, places: Indices) -> Callable[[Any], Any]:
    def constraint(z: Any) -> Any:
        if z.dtype != object:
            values.partly(places, z)
            return values.rows[rows]
        values.partly(places, ExtractValue(z).ravel())
        slopes = values.slopes[rows][:, places].toarray()
        return InitializeAutoDiff(values.rows[rows], slopes).ravel()

    return constraint
