"""Uno: sequential quadratic programs with a filter and a trust region (Vanaret and Leyffer)."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from schemas.problem import SolverSettings
from solver.backends.base import DEFAULT, Backend, NlpStatus, Outcome, Strategy
from solver.backends.plugin import RAISED, conclude, iterate_at, run
from solver.backends.watch import Watch
from solver.nlp.task import NlpTask

_LIMIT = "Terminated at a limit"

STATUSES: Mapping[str, NlpStatus] = MappingProxyType(
    {
        "Converged with feasible KKT point": NlpStatus.OPTIMAL,
        "Converged with feasible FJ point": NlpStatus.ACCEPTABLE,
        "Converged with infeasible stationary point": NlpStatus.INFEASIBLE,
        "Terminated with feasible small step": NlpStatus.ACCEPTABLE,
        "Terminated with infeasible small step": NlpStatus.INFEASIBLE,
        "Terminated with unbounded problem": NlpStatus.UNBOUNDED,
        "Terminated with not optimal point": NlpStatus.DIVERGED,
        _LIMIT: NlpStatus.ITERATION_LIMIT,
        RAISED: NlpStatus.DIVERGED,
    }
)
"""What Uno returns -> the neutral status. A limit of time is known by the watch."""


class Uno(Backend):
    """Uno's preset ``filtersqp`` with the QP solver BQPD, as CasADi's wheel ships them.

    Its QPs are dense in the null space: for small programs (a few hundred variables).
    """

    name = "uno"
    statuses = STATUSES

    def available(self) -> bool:
        """Whether CasADi brings the plugin."""
        return bool(ca.has_nlpsol("uno"))

    def refusal(self, task: NlpTask) -> str:
        """Uno takes every program."""
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
        """Solve by SQP; the callback sees each accepted iterate, the start is shown here."""
        del warm, strategy
        watch.see(iterate_at(task, task.start))
        # Uno prints a line for each variable with equal bounds, whatever its logger is told.
        upper = np.where(task.lower == task.upper, np.nextafter(task.upper, np.inf), task.upper)
        task = replace(task, upper=upper)
        options = {"cache": _functions(task), "uno": _options(settings, watch)}
        return conclude("Uno", run("uno", task, watch, options, _raw), STATUSES, watch)


def _raw(stats: Mapping[str, Any]) -> str:
    """The status of the solution; Uno calls a limit a point that is not optimal."""
    limited = stats["unified_return_status"] == "SOLVER_RET_LIMITED"
    return _LIMIT if limited else str(stats["return_status"])


def _options(settings: SolverSettings, watch: Watch) -> dict[str, Any]:
    return {
        "preset": "filtersqp",
        "logger": "SILENT",
        "max_iterations": settings.max_iterations,
        "time_limit": float(np.clip(watch.remaining(), 1e-3, 1e6)),
        "primal_tolerance": settings.tolerance,
        "dual_tolerance": settings.tolerance,
    }


def _functions(task: NlpTask) -> dict[str, ca.Function]:
    """The derivatives under the names by which the plugin looks for them."""
    nlp, z, none = task.nlp, ca.MX.sym("x", len(task.start)), ca.MX.sym("p", 0)
    sigma, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", len(task.row_lower))
    outputs = {
        "nlp_grad_f": nlp.gradient(z, none)[1],
        "nlp_jac_g": nlp.jacobian(z, none)[1],
    }
    functions = {name: ca.Function(name, [z, none], [value]) for name, value in outputs.items()}
    hessian = nlp.hessian(z, none, sigma, lam)
    return functions | {"nlp_hess_l": ca.Function("nlp_hess_l", [z, none, sigma, lam], [hessian])}
