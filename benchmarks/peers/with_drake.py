"""Drake's DirectCollocation with IPOPT and with SNOPT; the dynamics as its own symbolic system.

Its control is piecewise linear. Its ``AddRunningCost`` integrates by the trapezoidal rule, which
would need thousands of knots for five digits; here the cost is the exact integral of the squared
control, with which Drake converges with order 4. A family is a solver; a setting, segments.
"""

import time

import numpy as np
from pydrake.planning import DirectCollocation
from pydrake.solvers import IpoptSolver, SnoptSolver
from pydrake.symbolic import Expression, Variable, cos, sin
from pydrake.systems.primitives import SymbolicVectorSystem
from pydrake.trajectories import PiecewisePolynomial

from benchmarks.peers.measuring import Solved, Tool, ladder, main
from benchmarks.peers.problems import Problem

_SOLVERS = {"ipopt": IpoptSolver, "snopt": SnoptSolver}


def build(problem: Problem, segments: int) -> DirectCollocation:
    """The program with bounds, ends, cost and guess."""
    x = [Variable(f"x{i}") for i in range(problem.states)]
    u = [Variable(f"u{i}") for i in range(problem.controls)]
    rate = [Expression(1.0) * row for row in problem.rate(x, u, sin, cos)]
    system = SymbolicVectorSystem(state=x, input=u, dynamics=rate, output=x)
    step = problem.duration / segments
    program = DirectCollocation(system, system.CreateDefaultContext(), segments + 1, step, step)
    nlp = program.prog()
    nlp.AddBoundingBoxConstraint(problem.start, problem.start, program.initial_state())
    nlp.AddBoundingBoxConstraint(problem.end, problem.end, program.final_state())
    lower, upper = np.transpose(problem.bounds)
    bounded = np.isfinite(lower)
    for k in range(segments + 1):
        point = np.concatenate([program.state(k), program.input(k)])
        nlp.AddBoundingBoxConstraint(lower[bounded], upper[bounded], point[bounded])
    one = np.eye(problem.controls)
    square = step / 3 * np.block([[2 * one, one], [one, 2 * one]])
    for k in range(segments):
        pair = np.concatenate([program.input(k), program.input(k + 1)])
        nlp.AddQuadraticCost(square, np.zeros(len(pair)), 0.0, pair, is_convex=True)
    ends = np.transpose([problem.start, problem.end])
    line = PiecewisePolynomial.FirstOrderHold([0.0, problem.duration], ends)
    program.SetInitialTrajectory(PiecewisePolynomial(), line)
    return program


def solve(problem: Problem, family: str, setting: int) -> Solved:
    """Build and solve."""
    began = time.perf_counter()
    nlp = build(problem, setting).prog()
    built = time.perf_counter()
    result = _SOLVERS[family]().Solve(nlp, nlp.initial_guess(), None)
    ended = time.perf_counter()
    objective = result.get_optimal_cost() if result.is_success() else float("nan")
    return Solved(objective, ended - began, ended - built, None)


if __name__ == "__main__":
    main(Tool(solve, dict.fromkeys(_SOLVERS, ladder(5, 400))))
