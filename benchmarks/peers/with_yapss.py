"""Yapss: Radau collocation in NumPy, derivatives through CasADi, IPOPT called directly.

A family is the number of points of an interval; a setting, intervals.
"""

import time
from typing import Any

import numpy as np
import yapss
import yapss.math
from yapss._private import solver as inside

from benchmarks.peers.measuring import Solved, Tool, ladder, main
from benchmarks.peers.problems import Problem


def build(problem: Problem, points: int, intervals: int) -> yapss.Problem:
    """The problem with mesh and guess."""
    whole = yapss.Problem(name=problem.name, nx=[problem.states], nu=[problem.controls], nq=[1])

    def continuous(arg: Any) -> None:
        phase = arg.phase[0]
        x, u = list(phase.state), list(phase.control)
        phase.dynamics[:] = problem.rate(x, u, yapss.math.sin, yapss.math.cos)
        phase.integrand[0] = sum(control**2 for control in u)

    def objective(arg: Any) -> None:
        arg.objective = arg.phase[0].integral[0]

    whole.functions.continuous, whole.functions.objective = continuous, objective
    bounds, (lower, upper) = whole.bounds.phase[0], np.transpose(problem.bounds)
    bounds.initial_time.lower = bounds.initial_time.upper = 0.0
    bounds.final_time.lower = bounds.final_time.upper = problem.duration
    bounds.initial_state.lower[:] = bounds.initial_state.upper[:] = problem.start
    bounds.final_state.lower[:] = bounds.final_state.upper[:] = problem.end
    bounds.state.lower[:], bounds.state.upper[:] = lower[: problem.states], upper[: problem.states]
    bounds.control.lower[:] = lower[problem.states :]
    bounds.control.upper[:] = upper[problem.states :]
    guess, mesh = whole.guess.phase[0], whole.mesh.phase[0]
    guess.time = [0.0, problem.duration]
    guess.state = np.transpose([problem.start, problem.end])
    guess.control = np.zeros((problem.controls, 2))
    mesh.collocation_points, mesh.fraction = [points] * intervals, [1 / intervals] * intervals
    whole.spectral_method = "lgr"
    whole.derivatives.method, whole.derivatives.order = "auto", "second"
    whole.ipopt_options.print_level = 0
    whole.ipopt_options.sb = "yes"
    return whole


class _Clock:
    """Yapss does not tell how long IPOPT takes: time its only call of IPOPT."""

    def __init__(self) -> None:
        self.seconds, self._solve = 0.0, inside._solve_ipopt_problem  # noqa: SLF001 - no public way
        inside._solve_ipopt_problem = self  # noqa: SLF001

    def __call__(self, *args: Any, **options: Any) -> Any:
        began = time.perf_counter()
        answer = self._solve(*args, **options)
        self.seconds = time.perf_counter() - began
        return answer


_CLOCK = _Clock()


def solve(problem: Problem, family: str, setting: int) -> Solved:
    """Build and solve."""
    began = time.perf_counter()
    solution = build(problem, int(family), setting).solve()
    seconds = time.perf_counter() - began
    settled = solution.nlp_info.ipopt_status in (0, 1)  # solved, solved to acceptable level
    objective = float(solution.objective) if settled else float("nan")
    return Solved(objective, seconds, _CLOCK.seconds, None)


if __name__ == "__main__":
    main(Tool(solve, {"4": ladder(2, 60), "8": ladder(1, 20), "15": ladder(1, 8), "30": [1, 2, 3]}))
