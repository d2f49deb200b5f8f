"""Simulation that can be trusted: numpy and scipy only, nothing shared with what it judges.

Of the solver it uses the numeric tapes; mechanisms are read from the spec a second time here, by
body Jacobians, so that an error of the mechanics in `solver.mechanics` shows as a difference.
"""

from solver.simulation.multibody import Multibody
from solver.simulation.simulate import simulate

__all__ = ["Multibody", "simulate"]
