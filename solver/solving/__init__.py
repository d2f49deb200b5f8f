"""One program solved: warm or cold, by a portfolio, and what there is to say where it fails."""

from solver.solving.findings import Findings, find
from solver.solving.portfolio import Won
from solver.solving.task import solve_task
from solver.solving.unmet import limits_of

__all__ = ["Findings", "Won", "find", "limits_of", "solve_task"]
