"""IPOPT: interior point with exact derivatives, the default (Waechter and Biegler, 2006)."""

import time
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from schemas.errors import EngineFault
from schemas.problem import SolverSettings
from solver.backends.base import Backend, NlpStatus, Outcome
from solver.backends.memory import memory_watch
from solver.backends.watch import FEASIBLE, Iterate, StopCause, Watch
from solver.nlp.task import NlpTask

STATUSES: Mapping[str, NlpStatus] = MappingProxyType(
    {
        "Solve_Succeeded": NlpStatus.OPTIMAL,
        "Solved_To_Acceptable_Level": NlpStatus.ACCEPTABLE,
        "Feasible_Point_Found": NlpStatus.OPTIMAL,
        "Search_Direction_Becomes_Too_Small": NlpStatus.ACCEPTABLE,
        "Infeasible_Problem_Detected": NlpStatus.INFEASIBLE,
        "Restoration_Failed": NlpStatus.INFEASIBLE,
        "Not_Enough_Degrees_Of_Freedom": NlpStatus.INFEASIBLE,
        "Error_In_Step_Computation": NlpStatus.DIVERGED,
        "Diverging_Iterates": NlpStatus.DIVERGED,
        "Maximum_Iterations_Exceeded": NlpStatus.ITERATION_LIMIT,
        "Maximum_CpuTime_Exceeded": NlpStatus.TIME_LIMIT,
        "Maximum_WallTime_Exceeded": NlpStatus.TIME_LIMIT,
        "User_Requested_Stop": NlpStatus.STOPPED,
        "Invalid_Number_Detected": NlpStatus.INVALID_NUMBER,
    }
)
"""What IPOPT returns -> the neutral status. Anything else is a fault of the engine."""

_SETTLED = ("Solve_Succeeded", "Solved_To_Acceptable_Level", "User_Requested_Stop")
_ENDED_EARLY = (NlpStatus.STOPPED, NlpStatus.TIME_LIMIT, NlpStatus.ITERATION_LIMIT)

_CAUSES = {
    StopCause.REQUEST: NlpStatus.STOPPED,
    StopCause.DEADLINE: NlpStatus.TIME_LIMIT,
    StopCause.UNBOUNDED: NlpStatus.UNBOUNDED,
}


class Ipopt(Backend):
    """IPOPT with MUMPS, as CasADi's wheel ships them."""

    name = "ipopt"
    statuses = STATUSES

    def available(self) -> bool:
        """Whether CasADi brings the plugin."""
        return bool(ca.has_nlpsol("ipopt"))

    def refusal(self, task: NlpTask) -> str:
        """IPOPT takes every program."""
        del task
        return ""

    def solve(
        self, task: NlpTask, settings: SolverSettings, watch: Watch, *, warm: bool
    ) -> Outcome:
        """Solve by interior points; the callback sees each iterate."""
        callback = _Callback(task, watch)
        options = {**_options(settings, watch, warm=warm), **task.nlp.derivatives()}
        with memory_watch(options) as check_memory:
            solver = ca.nlpsol(
                "ipopt",
                "ipopt",
                {"x": task.nlp.symbols, "f": task.nlp.objective, "g": task.nlp.rows},
                {**options, "iteration_callback": callback},
            )
            began = time.perf_counter()
            result = solver(
                x0=task.start,
                lbx=task.lower,
                ubx=task.upper,
                lbg=task.row_lower,
                ubg=task.row_upper,
            )
            seconds = time.perf_counter() - began
            raw = str(solver.stats()["return_status"])
            if raw not in _SETTLED:
                check_memory()
        if watch.fault is not None:
            raise watch.fault
        if raw not in STATUSES:
            raise EngineFault(f"IPOPT ended with {raw}.", "Please report this problem.")
        z, rows = result["x"].full().ravel(), result["g"].full().ravel()
        final = Iterate(z, rows, float(result["f"]), task.violation(rows))
        chosen, status = final, _status(raw, final, watch)
        if status in _ENDED_EARLY and watch.best is not None:
            chosen = watch.best
        return Outcome(status, raw, chosen, max(watch.iterations, 0), seconds)


def _options(settings: SolverSettings, watch: Watch, *, warm: bool) -> dict[str, Any]:
    options: dict[str, Any] = {
        "print_time": False,
        "show_eval_warnings": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": settings.tolerance,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.max_iter": settings.max_iterations,
        "ipopt.max_wall_time": float(np.clip(watch.remaining(), 1e-3, 1e6)),
        "iteration_callback_step": 1,
    }
    if warm:
        options |= {"ipopt.mu_init": 1e-4, "ipopt.bound_push": 1e-6, "ipopt.bound_frac": 1e-6}
    return options


def _status(raw: str, final: Iterate, watch: Watch) -> NlpStatus:
    """The table, told apart further by what the iterate and the watch know."""
    status = STATUSES[raw]
    if status is NlpStatus.STOPPED and watch.cause is not None:
        return _CAUSES[watch.cause]
    feasible = final.violation <= FEASIBLE
    if status is NlpStatus.ACCEPTABLE and not feasible:
        return NlpStatus.INFEASIBLE
    if status is NlpStatus.INFEASIBLE and feasible:
        return NlpStatus.ACCEPTABLE
    return status


class _Callback(ca.Callback):
    """Hands each iterate to the watch."""

    def __init__(self, task: NlpTask, watch: Watch) -> None:
        super().__init__()
        self.task, self.watch = task, watch
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

    def eval_buffer(self, arguments: Sequence[memoryview], results: Sequence[memoryview]) -> int:
        # Buffers, not matrices: their conversion would double the cost of the callback.
        z, objective, rows = (np.frombuffer(memory) for memory in arguments[:3])
        violation = self.task.violation(rows)
        iterate = Iterate(z.copy(), rows.copy(), float(objective[0]), violation)
        np.frombuffer(results[0])[:] = self.watch.see(iterate)
        return 0
