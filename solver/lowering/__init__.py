"""From what users write to what methods solve: trees in, trees out; no casadi, no numbers solved.

Derivatives become states, chains of integrators or algebraic unknowns; second-order systems become
first-order ones; absolute values become slacks or smooth functions.
"""
