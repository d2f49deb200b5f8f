"""What a backend supplies, and the neutral words for how a solve ended.

A backend answers five questions: its name, whether it is available here, whether it accepts a
program and why not, the solve, and its status table. A new one is one file and one line in
``BACKENDS``.
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
class Outcome:
    """What a backend returns: the point it stands for, and why it ended.

    After a stop or a limit the point is the best iterate seen: the smallest violation until one
    is feasible, then the lowest objective. ``seconds`` were spent in the solver itself.
    """

    status: NlpStatus
    raw: str
    point: Iterate
    iterations: int
    seconds: float


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

    @abstractmethod
    def solve(
        self, task: NlpTask, settings: SolverSettings, watch: Watch, *, warm: bool
    ) -> Outcome:
        """Solve, reporting every iteration to ``watch``. ``warm``: the start is nearly optimal.

        Raises
        ------
        EngineFault
            If the solver itself fails.
        MemoryError
            If memory runs out.
        """
