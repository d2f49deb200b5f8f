"""From what users write to what methods solve: trees in, trees out; no casadi, no numbers solved.

Derivatives become states, chains of integrators or algebraic unknowns; second-order systems become
first-order ones; absolute values become slacks or smooth functions.
"""

from solver.lowering.form import Form, Unknowns
from solver.lowering.lower import lower, lower_native

__all__ = ["Form", "Unknowns", "lower", "lower_native"]
