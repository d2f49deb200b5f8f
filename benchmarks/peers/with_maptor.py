"""Maptor: Radau collocation through CasADi's Opti and IPOPT, on meshes that are given.

A family is the number of points of an interval; a setting, intervals.
"""

import time

import casadi as ca
import maptor
import numpy as np

from benchmarks.peers.measuring import Solved, Tool, ladder, main
from benchmarks.peers.problems import Problem

_QUIET = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False, "record_time": True}


def build(problem: Problem, points: int, intervals: int) -> maptor.Problem:
    """The problem with mesh and guess."""
    whole = maptor.Problem(problem.name)
    phase = whole.set_phase(1)
    phase.time(initial=0.0, final=problem.duration)
    bounds = [tuple(v if np.isfinite(v) else None for v in pair) for pair in problem.bounds]
    x = [
        phase.state(f"x{i}", initial=a, final=b, boundary=bounds[i])
        for i, (a, b) in enumerate(zip(problem.start, problem.end, strict=True))
    ]
    u = [
        phase.control(f"u{i}", boundary=bounds[problem.states + i]) for i in range(problem.controls)
    ]
    phase.dynamics(dict(zip(x, problem.rate(x, u, ca.sin, ca.cos), strict=True)))
    whole.minimize(phase.add_integral(sum(control**2 for control in u)))
    phase.mesh([points] * intervals, np.linspace(-1.0, 1.0, intervals + 1))
    shares = [np.linspace(k, k + 1, points + 1) / intervals for k in range(intervals)]
    phase.guess(
        states=[np.transpose([problem.guess(s) for s in span]) for span in shares],
        controls=[np.zeros((problem.controls, points))] * intervals,
        initial_time=0.0,
        terminal_time=problem.duration,
    )
    return whole


def solve(problem: Problem, family: str, setting: int) -> Solved:
    """Build and solve."""
    began = time.perf_counter()
    whole = build(problem, int(family), setting)
    solution = maptor.solve_fixed_mesh(whole, nlp_options=_QUIET, show_summary=False)
    seconds = time.perf_counter() - began
    stats = solution.opti.stats()
    objective = solution.status["objective"] if solution.status["success"] else float("nan")
    return Solved(float(objective), seconds, stats["t_wall_total"], stats["iter_count"])


if __name__ == "__main__":
    main(Tool(solve, {"4": ladder(2, 60), "8": ladder(1, 20), "15": ladder(1, 8), "30": [1, 2, 3]}))
