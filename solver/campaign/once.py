"""The solve that stages and guesses repeat."""

from collections.abc import Callable

from schemas.problem import Problem
from schemas.results import Solution
from solver.run import Run

SolveOnce = Callable[[Problem, Run], Solution]
"""Solves one problem, its ``stages`` and ``multistart`` aside, within the run's deadline."""
