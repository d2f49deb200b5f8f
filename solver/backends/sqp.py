"""SQP with exact Hessians and a line search: CasADi's ``sqpmethod``, its QPs solved by IPOPT.

Of the QP solvers in CasADi's wheel, IPOPT alone stood all test problems: exact Hessians are
indefinite, and made definite they cost hundreds of iterations.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from schemas.problem import SolverSettings
from solver.backends.base import DEFAULT, Backend, NlpStatus, Outcome, Strategy
from solver.backends.plugin import RAISED, conclude, run
from solver.backends.watch import FEASIBLE, Iterate, Watch
from solver.nlp.task import NlpTask

_STUCK = "Violation_Falls_No_More"
_PATIENCE = 100  # iterations without a smaller violation

STATUSES: Mapping[str, NlpStatus] = MappingProxyType(
    {
        "Solve_Succeeded": NlpStatus.OPTIMAL,
        "Search_Direction_Becomes_Too_Small": NlpStatus.ACCEPTABLE,
        "Maximum_Iterations_Exceeded": NlpStatus.ITERATION_LIMIT,
        "User_Requested_Stop": NlpStatus.STOPPED,
        RAISED: NlpStatus.DIVERGED,
        "Non_Regular_Sensitivities": NlpStatus.INVALID_NUMBER,
        _STUCK: NlpStatus.DIVERGED,
    }
)
"""What the method returns -> the neutral status.

It cannot tell an infeasible problem from a cycle: for both, the violation falls no more.
"""

_SUBPROBLEM = 200  # iterations of one QP: an unbounded one never ends
_CONSTANT = ("ipopt.jac_c_constant", "ipopt.jac_d_constant", "ipopt.hessian_constant")


class Sqp(Backend):
    """A line-search SQP: few evaluations, and a whole QP at each iteration."""

    name = "sqp"
    statuses = STATUSES

    def available(self) -> bool:
        """Whether CasADi brings the plugins."""
        return bool(ca.has_nlpsol("sqpmethod") and ca.has_nlpsol("ipopt"))

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
        """Solve by SQP; the callback sees each iterate, and the clock between QPs."""
        del warm, strategy
        options = _options(settings, watch) | {"cache": _functions(task)}
        patience = _Patience(watch)
        ended = run("sqpmethod", task, watch, options, see=patience.see)
        if patience.lost:
            ended = ended._replace(raw=_STUCK)
        return conclude("The SQP method", ended, STATUSES, watch)


class _Patience:
    """Gives up where the violation falls no more."""

    def __init__(self, watch: Watch) -> None:
        self.watch, self.least, self.since = watch, math.inf, 0

    @property
    def lost(self) -> bool:
        """Whether it has given up."""
        return self.least > FEASIBLE and self.since >= _PATIENCE

    def see(self, iterate: Iterate) -> bool:
        """Show an iterate to the watch; whether to stop."""
        lower = iterate.violation < 0.99 * self.least
        self.least = iterate.violation if lower else self.least
        self.since = 0 if lower else self.since + 1
        return self.watch.see(iterate) or self.lost


def _options(settings: SolverSettings, watch: Watch) -> dict[str, Any]:
    subproblem: dict[str, Any] = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.max_iter": _SUBPROBLEM,
        "ipopt.max_wall_time": float(np.clip(watch.remaining(), 1e-3, 1e6)),
    }
    subproblem |= dict.fromkeys(_CONSTANT, "yes")
    return {
        "max_iter": settings.max_iterations,
        "tol_pr": settings.tolerance,
        "tol_du": settings.tolerance,
        "print_header": False,
        "print_iteration": False,
        "print_status": False,
        "show_eval_warnings": False,
        "qpsol": "nlpsol",
        "qpsol_options": {
            "nlpsol": "ipopt",
            "nlpsol_options": subproblem,
            "error_on_fail": False,
        },
    }


def _functions(task: NlpTask) -> dict[str, ca.Function]:
    """The derivatives under the names by which the plugin looks for them."""
    nlp, z, none = task.nlp, ca.MX.sym("x", len(task.start)), ca.MX.sym("p", 0)
    sigma, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", len(task.row_lower))
    objective, gradient = nlp.gradient(z, none)
    rows, jacobian = nlp.jacobian(z, none)
    hessian = ca.triu2symm(nlp.hessian(z, none, sigma, lam))
    return {
        "nlp_jac_fg": ca.Function("nlp_jac_fg", [z, none], [objective, gradient, rows, jacobian]),
        "nlp_hess_l": ca.Function("nlp_hess_l", [z, none, sigma, lam], [hessian]),
    }
