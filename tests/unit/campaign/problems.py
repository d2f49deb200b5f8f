"""A point that walks around a disc: there are two ways, one of them shorter."""

import time
from typing import Any

from schemas.events import EngineEvent
from schemas.problem import Problem
from schemas.reading import read_problem
from schemas.results import Solution
from solver.once import solve_once
from solver.run import Run


def detour(**changes: Any) -> dict[str, Any]:
    """From one side of a disc to the other; ``changes`` replace fields of the problem."""
    return {
        "name": "detour",
        "phases": [
            {
                "name": "walk",
                "system": {
                    "kind": "ode",
                    "parameters": {"r": 0.3},
                    "states": ["x", "y"],
                    "controls": ["u", "w"],
                    "derivatives": {"x": "u", "y": "w"},
                },
                "time": {"initial": 0, "final": 1},
                "bounds": {"x": [-1, 2], "y": [-1, 1], "u": [-5, 5], "w": [-5, 5]},
                "initial": {"x": 0, "y": 0},
                "final": {"x": 1, "y": 0},
                "path": [
                    {"name": "apart", "expression": "(x - 0.5)^2 + (y - 0.1)^2 - r^2", "lower": 0}
                ],
                "integrals": {"effort": "u^2 + w^2"},
            }
        ],
        "objective": {"minimize": "effort"},
        "method": {"kind": "hermite_simpson", "segments": 12, "control": "linear"},
        "refinement": None,
        "certificate": {"tolerance": 0.1, "constraint_tolerance": 0.1},
    } | changes


def read(**changes: Any) -> Problem:
    """The same, checked."""
    return read_problem(detour(**changes))


class Recorder:
    """A run that keeps its events, and the solve that it is handed to."""

    def __init__(self, seconds: float = 60.0) -> None:
        self.events: list[EngineEvent] = []
        self.problems: list[Problem] = []
        self.deadlines: list[float] = []
        self.stop = False
        self.run = Run(self.events.append, time.monotonic() + seconds, lambda: self.stop)

    def solve(self, problem: Problem, run: Run) -> Solution:
        """One problem, whatever its stages and guesses."""
        self.problems.append(problem)
        self.deadlines.append(run.deadline - time.monotonic())
        return solve_once(problem, run, lambda _: None)

    @property
    def notes(self) -> list[str]:
        """What was announced."""
        return [note for event in self.events if (note := getattr(event, "note", ""))]
