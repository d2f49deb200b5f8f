"""From what users write to what methods solve: trees in, trees out; no casadi, no numbers solved.

Derivatives become states, chains of integrators or algebraic unknowns; second-order systems become
first-order ones; absolute values become slacks or smooth functions.
"""

from solver.lowering.form import Form, Holonomic, Unknowns
from solver.lowering.lower import STRETCH, lower, lower_native
from solver.lowering.slacks import Slacks, slacks
from solver.lowering.smoothed import smoothed

__all__ = [
    "STRETCH",
    "Form",
    "Holonomic",
    "Slacks",
    "Unknowns",
    "lower",
    "lower_native",
    "slacks",
    "smoothed",
]
