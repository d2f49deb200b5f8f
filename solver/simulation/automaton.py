"""A hybrid automaton: smooth flows between guards, and jumps where a guard passes zero.

Source: 003, sections 6.2.1 and 6.4.3. What a mode is, only the automaton knows: `execution` runs
any of them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from schemas.simulated import SimulationStatus
from solver.numeric.tape import Array

Rates = Callable[[float, Array], Array]
Mode_contra = TypeVar("Mode_contra", contravariant=True)


class Flow(NamedTuple):
    """The motion within a mode.

    Attributes
    ----------
    rates
        dy/dt (n,) of a time and a state (n,).
    guards
        Positive as long as the mode holds: (g, k), of times (k,) and states (n, k).
    armed
        Of each guard whether it has to be positive from the start: then it fires at once where
        it is not. One that is not armed and starts below waits until it has risen.
    """

    rates: Rates
    guards: Callable[[Array, Array], Array]
    armed: NDArray[np.bool_]


class Stop(NamedTuple):
    """The end of a motion before its time."""

    status: SimulationStatus
    message: str


@dataclass(frozen=True, slots=True)
class Jump:
    """What happens at an instant: the mode and the state after it, and records of the events.

    With ``stop`` the motion ends here.
    """

    mode: Any
    state: Array
    records: tuple[Any, ...] = ()
    stop: Stop | None = None


class Moment(NamedTuple):
    """A time and the state (n,) then.

    What drives the motion may jump at some times; ``within`` is a time between two of those, and
    says on which side of a jump the moment is.
    """

    time: float
    state: Array
    within: float


class Automaton(Protocol[Mode_contra]):
    """Modes, each with a flow, and jumps between them."""

    def begin(self, moment: Moment) -> Jump:
        """The mode to start in; where the start is itself an event, after it."""
        ...

    def flow(self, mode: Mode_contra, within: float) -> Flow:
        """The motion within a mode, and within a piece of what drives it (see `Moment`)."""
        ...

    def jump(self, mode: Mode_contra, fired: tuple[int, ...], moment: Moment) -> Jump:
        """What happens as some guards of a mode's flow fall through zero."""
        ...
