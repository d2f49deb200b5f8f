"""One call of the engine within its budget; whatever happens in it becomes an outcome."""

import time
from collections.abc import Callable
from typing import Any, Protocol

from schemas.events import EngineEvent
from schemas.problem import Problem
from schemas.results import Solution
from worker import limits, outcomes
from worker.outcomes import Outcome
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


Render = Callable[[dict[str, Any], dict[str, Any]], str]
"""``footfall.report.render``: a result and its problem to a page."""


def attempt(
    engine: Engine,
    problem: Callable[[], Problem],
    reporter: Reporter,
    *,
    seconds: float,
    megabytes: int,
    on_snapshot: Callable[[Solution], None],
) -> Outcome:
    """Read the problem and solve it, both inside of the budget; nothing is raised."""
    deadline = time.monotonic() + seconds
    try:
        with limits.memory(megabytes):
            solution = engine(
                problem(),
                on_event=reporter,
                deadline=deadline,
                should_stop=lambda: reporter.stop,
                on_snapshot=on_snapshot,
            )
    except Exception as error:  # noqa: BLE001 - whatever the engine does, the job must end
        return outcomes.failed(error, reporter.job_id)
    return outcomes.solved(solution)
