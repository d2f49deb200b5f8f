"""Footfall's engine on its own examples: one mesh, error and certificate included.

What nobody else does, error and certificate, is left out of ``seconds`` but not out of the time of
the process. A family is a method, with its points; a setting, segments.
"""

import time

import examples
from benchmarks.peers.measuring import Solved, Tool, ladder, main
from benchmarks.peers.problems import Problem
from schemas.reading import read_problem
from solver import solve as solve_whole


def solve(problem: Problem, family: str, setting: int) -> Solved:
    """Read, build, solve, certify."""
    began = time.perf_counter()
    kind, _, points = family.partition(" ")
    method = {"kind": kind, "segments": setting} | ({"points": int(points)} if points else {})
    document = examples.load(problem.name) | {"method": method, "refinement": None}
    result = solve_whole(read_problem(document))
    judging = result.timing.refine + result.timing.certify
    seconds = time.perf_counter() - began - judging
    objective = float("nan") if result.objective is None else result.objective
    return Solved(objective, seconds, result.solver.seconds, result.solver.iterations)


if __name__ == "__main__":
    radau = {"radau 4": ladder(2, 60), "radau 8": ladder(1, 20), "radau 15": ladder(1, 8)}
    main(Tool(solve, {"hermite_simpson": ladder(5, 100)} | radau))
