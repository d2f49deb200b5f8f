"""Trajectories as curves: what guesses are and what every solve ends with."""

from solver.trajectory.guess import guessed_statics, initial_guesses
from solver.trajectory.trajectory import Trajectory

__all__ = ["Trajectory", "guessed_statics", "initial_guesses"]
