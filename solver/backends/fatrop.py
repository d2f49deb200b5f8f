"""Fatrop: interior point by stages (Vanroye, Sathya, De Schutter and Decre, 2023).

The program is brought into stage order (``chain``), which its linear algebra needs: its cost is
linear in the stages and cubic in the width of one.
"""

import time
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from schemas.problem import SolverSettings
from solver.backends.base import DEFAULT, Backend, NlpStatus, Outcome, Strategy
from solver.backends.chain import Chain, NoChain, Pattern, find_chain
from solver.backends.plugin import RAISED, Ended, called, conclude, iterate_at
from solver.backends.watch import Watch
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

_HUGE = 1e20
_SHUT = "Shut"  # by the watch: whatever the plugin then makes of it

STATUSES: Mapping[str, NlpStatus] = MappingProxyType(
    {
        "Success": NlpStatus.OPTIMAL,
        "Max_Iter_Exceeded": NlpStatus.ITERATION_LIMIT,
        "Stop_At_Tiny_Step": NlpStatus.ACCEPTABLE,
        "Stop_At_Acceptable_Point": NlpStatus.ACCEPTABLE,
        "Local_Infeasibility": NlpStatus.INFEASIBLE,
        "Feasible_Point_Found": NlpStatus.ACCEPTABLE,
        "Diverging_Iterates": NlpStatus.DIVERGED,
        "Error_In_Step_Computation": NlpStatus.DIVERGED,
        RAISED: NlpStatus.INVALID_NUMBER,
        _SHUT: NlpStatus.STOPPED,
    }
)
"""What Fatrop returns, in the order of its flags -> the neutral status."""

_FLAGS = [name for name in STATUSES if name not in (RAISED, _SHUT)]


class Fatrop(Backend):
    """Fatrop, as CasADi's wheel ships it."""

    name = "fatrop"
    statuses = STATUSES

    def available(self) -> bool:
        """Whether CasADi brings the plugin."""
        return bool(ca.has_nlpsol("fatrop"))

    def refusal(self, task: NlpTask) -> str:
        """Refuses what has no stage order: see ``find_chain``."""
        try:
            _chain(task)
        except NoChain as error:
            return f"fatrop does not accept this problem because {error}; ipopt does."
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
        """Solve by interior points over the stages."""
        del strategy
        staged = _Staged(task, _chain(task), watch)
        ended = staged.solve(_options(settings, warm=warm))
        return conclude("Fatrop", ended, STATUSES, watch)


def _options(settings: SolverSettings, *, warm: bool) -> dict[str, Any]:
    options: dict[str, Any] = {
        "print_level": 0,
        "max_iter": settings.max_iterations,
        "tolerance": settings.tolerance,
    }
    return options | ({"mu_init": 1e-4} if warm else {})


def _chain(task: NlpTask) -> Chain:
    """The task in stage order."""
    if task.nodes is None:
        raise NoChain("its variables are in no order of time")
    rows, columns = _entries(task.nlp.jacobian.sparsity_out(1))
    ones, others = _entries(task.nlp.hessian.sparsity_out(0))
    kept = np.isfinite(task.row_lower) | np.isfinite(task.row_upper)
    return find_chain(task.nodes, Pattern(rows, columns, ones, others), kept)


def _entries(sparsity: ca.Sparsity) -> tuple[Indices, Indices]:
    rows, columns = (np.array(side, dtype=int) for side in sparsity.get_triplet())
    return rows, columns


class _Staged:
    """A task in stage order, over y: the chain's variables."""

    def __init__(self, task: NlpTask, chain: Chain, watch: Watch) -> None:
        self.task, self.chain, self.watch = task, chain, watch
        self.own = np.flatnonzero(chain.order >= 0)  # rows that are no gap rows
        self.size, self.rows = len(chain.source), len(chain.order)
        self.eye = _Eye(task, watch)  # both live as long as the functions that call them
        self.gate = _Gate(self.eye)

    def solve(self, options: dict[str, Any]) -> Ended:
        """Run the plugin."""
        chain, y = self.chain, ca.MX.sym("y", self.size)
        objective, values = self.task.nlp.evaluate(y[chain.primary.tolist()])
        problem = {"x": y, "f": objective, "g": self._rows(y, values)}
        sizes = {"nx": chain.states, "nu": chain.inputs, "ng": chain.constraints}
        structure = {name: size.tolist() for name, size in sizes.items()}
        structure |= {"structure_detection": "manual", "N": len(chain.states) - 1}
        quiet = {"print_time": False, "show_eval_warnings": False}
        solver = ca.nlpsol(
            "fatrop",
            "fatrop",
            problem,
            {**structure, **quiet, "cache": self._functions(), "fatrop": options},
        )
        began = time.perf_counter()
        start = self.task.start[chain.source]
        result = called(lambda: solver(x0=start, **self._limits()))
        seconds = time.perf_counter() - began
        if result is None:
            last = self.watch.best or iterate_at(self.task, self.task.start)
            return Ended(RAISED, last, max(self.watch.iterations, 0), seconds)
        stats = solver.stats()["fatrop"]
        flag, count = int(stats["return_flag"]), int(stats["iterations_count"])
        raw = _FLAGS[flag] if 0 <= flag < len(_FLAGS) else f"flag {flag}"
        if self.eye.shut:
            raw = RAISED if self.eye.invalid else _SHUT
        row_multipliers = np.zeros(len(self.task.row_lower))
        row_multipliers[chain.order[self.own]] = result["lam_g"].full().ravel()[self.own]
        bound_multipliers = result["lam_x"].full().ravel()[chain.primary]
        final = iterate_at(self.task, result["x"].full().ravel()[chain.primary])
        return Ended(raw, final, count, seconds, row_multipliers, bound_multipliers)

    def _limits(self) -> dict[str, Array]:
        """Limits of the rows, gap rows zero; bounds where variables are read, else none."""
        chain, task = self.chain, self.task
        limits = {"lbx": np.full(self.size, -np.inf), "ubx": np.full(self.size, np.inf)}
        limits["lbx"][chain.primary], limits["ubx"][chain.primary] = task.lower, task.upper
        limits |= {"lbg": np.zeros(self.rows), "ubg": np.zeros(self.rows)}
        limits["lbg"][self.own] = task.row_lower[chain.order[self.own]]
        limits["ubg"][self.own] = task.row_upper[chain.order[self.own]]
        return limits

    def _functions(self) -> dict[str, ca.Function]:
        """What the plugin asks for, under its own names."""
        nlp, chain = self.task.nlp, self.chain
        y, none = ca.MX.sym("x", self.size), ca.MX.sym("p", 0)
        sigma, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", self.rows)
        z = y[chain.primary.tolist()]
        objective, rows = nlp.evaluate(z)
        slopes = _placed(nlp.gradient(z, none)[1], chain.primary, self.size)
        values, entries = nlp.jacobian(z, none)
        flat = ca.vertcat(entries.nz[:])
        jacobian = self._jacobian(_finite(flat) + self.eye(z, ca.sum1(flat)))
        own = _placed(lam[self.own.tolist()], chain.order[self.own], len(self.task.row_lower))
        hessian = _symmetric(nlp.hessian(z, none, sigma, own), chain.hessian, self.size)
        # The plugin asks for the Lagrangian's gradient beside the Hessian, and never reads it.
        unread = ca.MX.zeros(self.size)
        point, weighted = [y, none], [y, none, sigma, lam]
        return {
            "nlp_f": ca.Function("nlp_f", point, [objective]),
            "nlp_g": ca.Function("nlp_g", point, [self._rows(y, rows) + self.gate(y[0])]),
            "nlp_grad_f": ca.Function("nlp_grad_f", point, [slopes]),
            "nlp_jac_g": ca.Function("nlp_jac_g", point, [self._rows(y, values), jacobian]),
            "nlp_hess_l": ca.Function("nlp_hess_l", weighted, [unread, hessian]),
        }

    def _rows(self, y: ca.MX, values: ca.MX) -> ca.MX:
        """Rows of the chain: the program's, and the gap rows."""
        row, following, copy = self.chain.gaps
        gaps = y[following.tolist()] - y[copy.tolist()]
        own = values[self.chain.order[self.own].tolist()]
        return _placed(ca.vertcat(own, gaps), np.concatenate([self.own, row]), self.rows)

    def _jacobian(self, entries: ca.MX) -> ca.MX:
        gap, following, copy = self.chain.gaps
        live = np.flatnonzero(self.chain.jacobian[0] >= 0)
        rows = np.concatenate([self.chain.jacobian[0][live], gap, gap])
        columns = np.concatenate([self.chain.jacobian[1][live], following, copy])
        units = np.repeat([1.0, -1.0], len(gap))
        values = ca.vertcat(entries[live.tolist()], ca.DM(units))
        return _sparse(values, rows, columns, (self.rows, self.size))


def _placed(values: ca.MX, places: Indices, size: int) -> ca.MX:
    """A dense column with values at some places, zero elsewhere."""
    column = ca.MX.zeros(size)
    column[places.tolist()] = values
    return column


def _symmetric(upper: ca.MX, places: Indices, size: int) -> ca.MX:
    """Both triangles of a matrix from the entries of one, which may go anywhere."""
    one, other = places
    twice = np.flatnonzero(one != other)
    source = np.concatenate([np.arange(len(one)), twice])
    rows, columns = np.concatenate([one, other[twice]]), np.concatenate([other, one[twice]])
    return _sparse(_finite(upper.nz[source.tolist()]), rows, columns, (size, size))


def _finite(values: ca.MX) -> ca.MX:
    """Values without infinities or NaN, which the plugin would try to factorise for ever."""
    return ca.fmin(ca.fmax(values, -_HUGE), _HUGE)


def _sparse(values: ca.MX, rows: Indices, columns: Indices, shape: tuple[int, int]) -> ca.MX:
    """A sparse matrix from its entries in any order, no two alike."""
    order = np.lexsort((rows, columns))
    pattern = ca.Sparsity.triplet(*shape, rows[order].tolist(), columns[order].tolist())
    return ca.MX(pattern, values[order.tolist()])


class _Eye(ca.Callback):
    """Shows the watch each iterate; the plugin has no callback of its own.

    It stands in the Jacobian, which the plugin evaluates once an iteration, in its restoration
    phase too: z and the sum of the entries -> 0. An infinite sum ends the solve, too.
    """

    def __init__(self, task: NlpTask, watch: Watch) -> None:
        super().__init__()
        self.task, self.watch = task, watch
        self.last: Array | None = None
        self.shut = self.invalid = False
        self.construct("eye", {})

    def get_n_in(self) -> int:
        return 2

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, index: int) -> ca.Sparsity:
        return ca.Sparsity.dense(1 if index else len(self.task.start), 1)

    def has_eval_buffer(self) -> bool:
        return True

    def eval_buffer(self, arguments: Sequence[memoryview], results: Sequence[memoryview]) -> int:
        z, total = (np.frombuffer(memory) for memory in arguments)
        if not np.isfinite(total[0]):
            self.invalid = self.shut = True
        if self.last is None or not np.array_equal(z, self.last):  # the start is asked for twice
            self.last = z.copy()
            self.shut = self.watch.see(iterate_at(self.task, self.last)) or self.shut
        np.frombuffer(results[0])[:] = 0.0
        return 0


class _Gate(ca.Callback):
    """Ends the solve once the watch wants it to: 0 -> 0, then NaN.

    It stands in the rows. Without a number there, each trial step fails, and the restoration
    after them; anywhere else, the plugin would ignore it or try to factorise it for ever.
    """

    def __init__(self, eye: _Eye) -> None:
        super().__init__()
        self.eye = eye
        self.construct("gate", {})

    def get_n_in(self) -> int:
        return 1

    def get_n_out(self) -> int:
        return 1

    def has_eval_buffer(self) -> bool:
        return True

    def eval_buffer(self, arguments: Sequence[memoryview], results: Sequence[memoryview]) -> int:
        del arguments
        np.frombuffer(results[0])[:] = np.nan if self.eye.shut else 0.0
        return 0
