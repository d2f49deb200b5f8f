"""Trajectories as curves: what guesses are and what every solve ends with."""

from solver.trajectory.guess import initial_guess
from solver.trajectory.trajectory import Trajectory

__all__ = ["Trajectory", "initial_guess"]
