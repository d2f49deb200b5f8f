"""The discrete-gradient backward Euler: balances of momentum over finite steps.

Slope arithmetic (``slopes``, ``rules``, ``differences``) gives every quantity's exact change as
averaged Jacobian times the step; the balance (``balance``) is made of those, so that no step, of
whatever size, lets contacts, limits or springs do work that they should not. The proof is in
docs/theory.md.
"""

from solver.discrete.balance import Step, StepRows, step_rows
from solver.discrete.slopes import Slopes
from solver.discrete.turning import turn_rows

__all__ = ["Slopes", "Step", "StepRows", "step_rows", "turn_rows"]
