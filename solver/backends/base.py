"""What a backend supplies, and the neutral words for how a solve ended.

A backend answers six questions: its name, whether it is available here, whether it accepts a
program and why not, which strategies it knows, the solve, and its status table. A new one is one
file and one line in ``BACKENDS``.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from schemas.problem import SolverSettings
from solver.backends.watch import Iterate, Watch
from solver.nlp.task import NlpTask

Array = NDArray[np.float64]


class NlpStatus(StrEnum):
    """How an NLP solve ended, in every backend's common words."""

    OPTIMAL = "optimal"
    ACCEPTABLE = "acceptable"
    INFEASIBLE = "infeasible"
    DIVERGED = "diverged"
    UNBOUNDED = "unbounded"
    ITERATION_LIMIT = "iteration_limit"
    TIME_LIMIT = "time_limit"
    STOPPED = "stopped"
    INVALID_NUMBER = "invalid_number"


@dataclass(frozen=True, slots=True)
class Strategy:
    """How to go about a solve, in words that any backend may understand.

    ``adaptive``: choose the barrier parameter anew at each iteration, which helps hard problems
    and hurts some easy ones. ``rescaled``: divide rows and objective by their slopes at the start.
    ``free``: adaptive, and never held at one parameter; starts near its limits. For objectives
    that are linear in slacks. ``exact``: constraints to 1e-8, whatever the tolerance. ``steady``:
    as if constraints depended on each other, at the price of the last digits.
    """

    name: str = "default"
    adaptive: bool = False
    rescaled: bool = False
    free: bool = False
    exact: bool = False
    steady: bool = False


DEFAULT = Strategy()
ADAPTIVE = Strategy("adaptive barrier", adaptive=True)
RESCALED = Strategy("rescaled", rescaled=True)
FREE = Strategy("free barrier", adaptive=True, free=True)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a backend returns: the point it stands for, and why it ended.

    After a stop or a limit the point is the best iterate seen: the smallest violation until one
    is feasible, then the lowest objective. ``seconds`` were spent in the solver itself.

    The multipliers are those of the solver's last iterate, for the scaled rows (m,) and the
    scaled variables' bounds (n,), in CasADi's convention: at an optimum grad f + J' row + bound
    = 0, positive where the upper limit pushes. None where the solver gives none.
    """

    status: NlpStatus
    raw: str
    point: Iterate
    iterations: int
    seconds: float
    row_multipliers: Array | None = None
    bound_multipliers: Array | None = None


class Backend(ABC):
    """An NLP solver."""

    name: ClassVar[str]
    statuses: ClassVar[Mapping[str, NlpStatus]]

    @abstractmethod
    def available(self) -> bool:
        """Whether the solver is installed."""

    @abstractmethod
    def refusal(self, task: NlpTask) -> str:
        """Why this program is not accepted; empty where it is."""

    def offers(self, strategy: Strategy) -> bool:
        """Whether the strategy makes a difference here."""
        return not (strategy.adaptive or strategy.rescaled or strategy.steady)

    @abstractmethod
    def solve(
        self,
        task: NlpTask,
        settings: SolverSettings,
        watch: Watch,
        *,
        warm: bool,
        strategy: Strategy = DEFAULT,
    ) -> Outcome:
        """Solve, reporting every iteration to ``watch``. ``warm``: the start is nearly optimal.

        Raises
        ------
        EngineFault
            If the solver itself fails.
        MemoryError
            If memory runs out.
        """
