"""What the backends share that run a plugin of CasADi's ``nlpsol``."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from schemas.errors import EngineFault
from solver.backends.base import NlpStatus, Outcome
from solver.backends.watch import FEASIBLE, Iterate, StopCause, Watch
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]

RAISED = "Exception_In_Solver"
"""The raw status where a plugin raised instead of returning one."""

_GROSS = 0.1  # scaled violation far above any tolerance

_ENDED_EARLY = (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT, NlpStatus.ITERATION_LIMIT)

_CAUSES = {
    StopCause.REQUEST: NlpStatus.STOPPED,
    StopCause.DEADLINE: NlpStatus.TIME_LIMIT,
    StopCause.UNBOUNDED: NlpStatus.UNBOUNDED,
}


class Ended(NamedTuple):
    """How a plugin ended: its raw status, last iterate, multipliers, and the seconds in it."""

    raw: str
    final: Iterate
    iterations: int
    seconds: float
    row_multipliers: Array | None = None
    bound_multipliers: Array | None = None


def iterate_at(task: NlpTask, z: Array) -> Iterate:
    """The iterate at a point."""
    objective, rows = (part.full().ravel() for part in task.nlp.evaluate(z))
    return Iterate(z, rows, float(objective[0]), task.violation(rows, z))


def run(
    plugin: str,
    task: NlpTask,
    watch: Watch,
    options: Mapping[str, Any],
    status: Callable[[Mapping[str, Any]], str] = lambda stats: str(stats["return_status"]),
    see: Callable[[Iterate], bool] | None = None,
) -> Ended:
    """Run a plugin on the task as it is.

    ``status`` reads the raw status out of its statistics; ``see`` is asked at each iterate
    whether to stop, by default the watch.

    Raises
    ------
    MemoryError
        If memory runs out.
    """
    callback = _Callback(task, see or watch.see)  # CasADi does not keep it alive
    solver = ca.nlpsol(
        plugin,
        plugin,
        {"x": task.nlp.symbols, "f": task.nlp.objective, "g": task.nlp.rows},
        {**options, "iteration_callback": callback, "print_time": False},
    )
    began = time.perf_counter()
    limits = {"lbx": task.lower, "ubx": task.upper, "lbg": task.row_lower, "ubg": task.row_upper}
    result = called(lambda: solver(x0=task.start, **limits, **_multipliers(task)))
    seconds = time.perf_counter() - began
    if result is None:
        return Ended(
            RAISED, watch.best or iterate_at(task, task.start), max(watch.iterations, 0), seconds
        )
    z, rows = result["x"].full().ravel(), result["g"].full().ravel()
    stats = solver.stats()
    return Ended(
        status(stats),
        Iterate(z, rows, float(result["f"]), task.violation(rows, z)),
        int(stats["iter_count"]),
        seconds,
        result["lam_g"].full().ravel(),
        result["lam_x"].full().ravel(),
    )


def _multipliers(task: NlpTask) -> dict[str, Array]:
    """Where the multipliers begin, as far as the task knows; zero else."""
    known = {"lam_g0": task.row_multipliers, "lam_x0": task.bound_multipliers}
    return {name: values for name, values in known.items() if values is not None}


def called(solve: Callable[[], dict[str, ca.DM]]) -> dict[str, ca.DM] | None:
    """What the plugin returns; None where it raises, as some do where others have a status."""
    try:
        return solve()
    except RuntimeError as error:
        if "bad_alloc" in str(error):
            raise MemoryError("the NLP solver ran out of memory") from error
        return None


def conclude(name: str, ended: Ended, statuses: Mapping[str, NlpStatus], watch: Watch) -> Outcome:
    """The outcome, told apart further by what the last iterate and the watch know.

    Raises
    ------
    EngineFault
        If the status is not in the table.
    """
    if watch.fault is not None:
        raise watch.fault
    if ended.raw not in statuses and watch.cause is None:
        raise EngineFault(f"{name} ended with {ended.raw}.", "Please report this problem.")
    status = _status(statuses.get(ended.raw, NlpStatus.STOPPED), ended.final, watch)
    chosen = ended.final
    if status in _ENDED_EARLY and watch.best is not None:
        chosen = watch.best
    return Outcome(
        status,
        ended.raw,
        chosen,
        ended.iterations,
        ended.seconds,
        ended.row_multipliers,
        ended.bound_multipliers,
    )


def _status(status: NlpStatus, final: Iterate, watch: Watch) -> NlpStatus:
    if watch.cause is not None and status is not NlpStatus.OPTIMAL:
        return _CAUSES[watch.cause]
    if status is NlpStatus.OPTIMAL and not final.violation <= _GROSS:
        return NlpStatus.DIVERGED  # what compares to no number may look converged
    feasible = final.violation <= FEASIBLE
    if status is NlpStatus.ACCEPTABLE and not feasible:
        return NlpStatus.INFEASIBLE
    if status is NlpStatus.INFEASIBLE and feasible:
        return NlpStatus.ACCEPTABLE
    return status


class _Callback(ca.Callback):
    """Shows each iterate."""

    def __init__(self, task: NlpTask, see: Callable[[Iterate], bool]) -> None:
        super().__init__()
        self.task, self.see = task, see
        self.sizes = {"x": len(task.start), "f": 1, "g": len(task.row_lower)}
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, index: int) -> str:
        return str(ca.nlpsol_out(index))

    def get_sparsity_in(self, index: int) -> ca.Sparsity:
        name = ca.nlpsol_out(index)
        return ca.Sparsity.dense(self.sizes.get(name, 0), 1)

    def has_eval_buffer(self) -> bool:
        return True

    def eval_buffer(
        self, arguments: Sequence[memoryview | None], results: Sequence[memoryview]
    ) -> int:
        # Buffers, not matrices: their conversion would double the cost of the callback.
        given = [np.frombuffer(memory).copy() for memory in arguments[:3] if memory is not None]
        z = given[0]
        if len(given) == 1:  # Uno tells the point alone
            iterate = iterate_at(self.task, z)
        else:
            objective, rows = given[1:]
            iterate = Iterate(z, rows, float(objective[0]), self.task.violation(rows, z))
        np.frombuffer(results[0])[:] = self.see(iterate)
        return 0
