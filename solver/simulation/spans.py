"""What an execution of a hybrid automaton is told, and what it leaves behind."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from schemas.simulated import SimulationStatus
from solver.numeric.tape import Array
from solver.simulation.automaton import Stop


@dataclass(frozen=True, slots=True)
class Settings:
    """How to integrate and how to look for events.

    Attributes
    ----------
    tolerance
        Relative, of each integrator step; the absolute one is a hundredth of it.
    spacing
        The longest time between two looks at the guards, s.
    max_events
        After these the motion counts as one of infinitely many events.
    shortest
        Events closer to each other than this, ten in a row, count as that, too, s.
    halt
        Asked once a step, of the time and the number of events so far: a reason to end.
    """

    tolerance: float = 1e-10
    spacing: float = 0.01
    max_events: int = 10_000
    shortest: float = 1e-12
    halt: Callable[[float, int], Stop | None] = lambda *_: None


class Span(NamedTuple):
    """A mode from one event to the next.

    Attributes
    ----------
    times
        Of the integrator's steps, the ends included, (steps + 1,).
    curves
        One interpolant a step, of times (k,) to states (n, k).
    first, last
        The states at the ends, (n,).
    """

    mode: Any
    times: Array
    curves: Sequence[Callable[[Array], Array]]
    first: Array
    last: Array

    def __call__(self, times: Array) -> Array:
        """The states (n, k) at times (k,) within the span; the ends are exact."""
        where = np.clip(np.searchsorted(self.times, times) - 1, 0, max(len(self.curves) - 1, 0))
        states = np.repeat(self.first[:, None], len(times), axis=1)
        for step in np.unique(where) if len(self.curves) else []:
            states[:, where == step] = self.curves[step](times[where == step])
        states[:, times <= self.times[0]] = self.first[:, None]
        states[:, times >= self.times[-1]] = self.last[:, None]
        return states


class Record(NamedTuple):
    """An event: its time, the states before and after, and what the automaton says of it."""

    time: float
    before: Array
    after: Array
    events: tuple[Any, ...]


@dataclass
class Execution:
    """A motion through the modes of an automaton, and how it ended."""

    spans: list[Span] = field(default_factory=list)
    records: list[Record] = field(default_factory=list)
    status: SimulationStatus = SimulationStatus.FINISHED
    message: str = ""
    evaluations: int = 0
    steps: int = 0

    @property
    def end(self) -> float:
        """Where the motion ended, s."""
        return float(self.spans[-1].times[-1])

    @property
    def state(self) -> Array:
        """The last state, (n,)."""
        return self.spans[-1].last
