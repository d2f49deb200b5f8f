"""Planar mechanisms as equations: trees in, trees out.

Places of bodies are trees over coordinates, their rates come by differentiation, and the equations
of motion by recursive Newton-Euler with external forces, in absolute angles. No casadi, no mass
matrix, nothing solved.
"""

from solver.mechanics.equations import Equations, equations_of
from solver.mechanics.held import Held
from solver.mechanics.limits import limited

__all__ = ["Equations", "Held", "equations_of", "limited"]
