"""IPOPT: interior point with exact derivatives, the default (Waechter and Biegler, 2006)."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from schemas.problem import SolverSettings
from solver.backends.base import DEFAULT, Backend, NlpStatus, Outcome, Strategy
from solver.backends.memory import memory_watch
from solver.backends.plugin import conclude, run
from solver.backends.watch import Watch
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

_EXACT = 1e-8  # violation of a scaled row

_CONTINUED = {
    "ipopt.warm_start_init_point": "yes",
    "ipopt.mu_init": 1e-2,  # the next relaxation is far: smaller ones took up to twice as long
    **{
        f"ipopt.warm_start_{which}": 1e-9
        for which in (
            *("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac"),
            "mult_bound_push",
        )
    },
}
"""For a start with multipliers: the pushes of a start without leave the optimum it comes from."""

_SETTLED = ("Solve_Succeeded", "Solved_To_Acceptable_Level", "User_Requested_Stop")


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

    def offers(self, strategy: Strategy) -> bool:
        """IPOPT knows all of them."""
        del strategy
        return True

    def solve(
        self,
        task: NlpTask,
        settings: SolverSettings,
        watch: Watch,
        *,
        warm: bool,
        strategy: Strategy = DEFAULT,
    ) -> Outcome:
        """Solve by interior points; the callback sees each iterate."""
        options = _options(settings, watch, warm=warm) | _switches(strategy)
        if warm and task.row_multipliers is not None:
            options |= _CONTINUED
        options |= task.nlp.derivatives()
        with memory_watch(options) as check_memory:
            ended = run("ipopt", task, watch, options)
            if ended.raw not in _SETTLED:
                check_memory()
        return conclude("IPOPT", ended, STATUSES, watch)


def _options(settings: SolverSettings, watch: Watch, *, warm: bool) -> dict[str, Any]:
    options: dict[str, Any] = {
        "show_eval_warnings": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": settings.tolerance,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.max_iter": settings.max_iterations,
        # The systems are scaled and nearly banded: what MUMPS would do about that only costs.
        "ipopt.mumps_permuting_scaling": 0,
        "ipopt.mumps_pivot_order": 0,
        # Ten times sooner on to the next barrier than by default: measured on the gallery, as good
        # as that for most, and twice as fast where absolute values are smoothed.
        "ipopt.barrier_tol_factor": 100.0,
        "ipopt.max_wall_time": float(np.clip(watch.remaining(), 1e-3, 1e6)),
        "iteration_callback_step": 1,
    }
    if warm:
        options |= {"ipopt.mu_init": 1e-4, "ipopt.bound_push": 1e-6, "ipopt.bound_frac": 1e-6}
    return options


def _switches(strategy: Strategy) -> dict[str, Any]:
    options: dict[str, Any] = {}
    if strategy.adaptive:
        options["ipopt.mu_strategy"] = "adaptive"
    if strategy.free:
        # From a stage's solution or a coarser mesh; the usual pushes leave both, and 1e-6 is so
        # near that slacks stay where they are.
        options |= {
            "ipopt.adaptive_mu_globalization": "never-monotone-mode",
            "ipopt.bound_push": 1e-4,
            "ipopt.bound_frac": 1e-4,
        }
    if strategy.exact:
        options["ipopt.constr_viol_tol"] = _EXACT
        options["ipopt.barrier_tol_factor"] = 10.0  # sooner on, relaxed contacts get lost
    if strategy.steady:
        options["ipopt.perturb_always_cd"] = "yes"
    if strategy.rescaled:
        # Slopes above 1 are divided down to it; by default, those above 100.
        options["ipopt.nlp_scaling_max_gradient"] = 1.0
    return options
