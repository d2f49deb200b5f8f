"""One call of the engine within its budget; whatever happens in it becomes an outcome."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from schemas.events import EngineEvent
from schemas.problem import Problem
from schemas.results import Solution
from schemas.simulated import SimulationResult
from schemas.simulations import Simulation
from worker import limits, outcomes
from worker.outcomes import Finished, Outcome
from worker.reporting import Reporter


class Engine(Protocol):
    """``solver.solve``, or what a test puts in its place."""

    def __call__(
        self,
        problem: Problem,
        *,
        on_event: Callable[[EngineEvent], None],
        deadline: float | None,
        should_stop: Callable[[], bool],
        on_snapshot: Callable[[Solution], None],
    ) -> Solution:
        """Solve. ``deadline`` is a time of ``time.monotonic``."""


class Simulator(Protocol):
    """``solver.simulation.simulate``, or what a test puts in its place."""

    def __call__(
        self,
        simulation: Simulation,
        *,
        on_event: Callable[[EngineEvent], None],
        deadline: float,
        should_stop: Callable[[], bool],
    ) -> SimulationResult:
        """Simulate. ``deadline`` is a time of ``time.monotonic``."""


R = TypeVar("R", bound=Finished)
Render = Callable[[dict[str, Any], dict[str, Any]], str]
"""``footfall.report.render``: a result and the document it came of to a page."""


@dataclass(frozen=True, slots=True)
class Engines:
    """What a worker works with, loaded once before it forks."""

    solve: Engine
    simulate: Simulator
    render: Render


def attempt(
    work: Callable[[float], R], reporter: Reporter, *, seconds: float, megabytes: int
) -> Outcome[R]:
    """Do the work, which is told its deadline, inside of the budget; nothing is raised."""
    deadline = time.monotonic() + seconds
    try:
        with limits.memory(megabytes):
            finished = work(deadline)
    except Exception as error:  # noqa: BLE001 - whatever the engine does, the job must end
        return outcomes.failed(error, reporter.job_id)
    return outcomes.finished(finished)
