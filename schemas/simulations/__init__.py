"""Simulations: a system set going from a given state, as posted; and how one is read.

What comes back is `schemas.simulated.SimulationResult`.
"""

from schemas.simulations.document import (
    MAX_SAMPLES,
    SIMULATION_METHODS,
    Events,
    ExpressionSignal,
    Feedback,
    GainSchedule,
    Guard,
    SampledSignal,
    Signal,
    Simulation,
    SimulationMethod,
    Smooth,
    SolutionSignal,
    TimeStepping,
)
from schemas.simulations.reading import read_simulation

__all__ = [
    "MAX_SAMPLES",
    "SIMULATION_METHODS",
    "Events",
    "ExpressionSignal",
    "Feedback",
    "GainSchedule",
    "Guard",
    "SampledSignal",
    "Signal",
    "Simulation",
    "SimulationMethod",
    "Smooth",
    "SolutionSignal",
    "TimeStepping",
    "read_simulation",
]
