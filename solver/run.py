"""The circumstances of one solve: its clock, its deadline, who listens and who may stop it."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal

from schemas.events import EngineEvent, NlpIteration, StageStarted
from schemas.results import Timing, finite
from solver.backends import Watch

_PAUSE = 1.0  # s
_PAUSES_PER_COST = 20.0

Stage = Literal["build", "solve", "refine", "certify"]


@dataclass(slots=True)
class Pace:
    """Lets something happen once a second at the most, and for a twentieth of the time."""

    last: float
    cost: float = 0.0

    def due(self) -> bool:
        """Whether it is time again."""
        return time.monotonic() - self.last > max(_PAUSE, _PAUSES_PER_COST * self.cost)

    @contextmanager
    def measured(self) -> Iterator[None]:
        """Measure what it costs."""
        began = time.monotonic()
        yield
        self.last = time.monotonic()
        self.cost = self.last - began


@dataclass(slots=True)
class Run:
    """Measures the stages, passes events on, and makes the watch of each NLP solve."""

    on_event: Callable[[EngineEvent], None]
    deadline: float
    should_stop: Callable[[], bool]
    started: float = field(default_factory=time.monotonic)
    spent: dict[Stage, float] = field(default_factory=dict)
    current: Stage | None = None

    @contextmanager
    def stage(self, name: Stage) -> Iterator[None]:
        """Announce (once where it goes on) and time one stage of the pipeline."""
        if name != self.current:
            self.on_event(StageStarted(stage=name))
        self.current = name
        began = time.monotonic()
        try:
            yield
        finally:
            self.spent[name] = self.spent.get(name, 0.0) + time.monotonic() - began

    def pace(self) -> Pace:
        """How often a running solve may be looked at."""
        return Pace(self.started)

    def watch(self, mesh: int, keep: Callable[[Watch], None]) -> Watch:
        """The watch over the NLP solve on one mesh."""
        began = time.monotonic()

        def report(iteration: int, objective: float, violation: float) -> None:
            self.on_event(
                NlpIteration(
                    mesh=mesh,
                    iteration=iteration,
                    objective=finite(objective),
                    violation=finite(violation),
                    seconds=time.monotonic() - began,
                )
            )

        return Watch(self.deadline, self.should_stop, report, keep)

    def stopped(self) -> bool:
        """Whether the solve has been asked to end, or is out of time."""
        return self.should_stop() or time.monotonic() >= self.deadline

    def seconds(self) -> float:
        """Since the start."""
        return time.monotonic() - self.started

    def timing(self) -> Timing:
        """Seconds of each stage so far."""
        stages: tuple[Stage, ...] = ("build", "solve", "refine", "certify")
        return Timing(
            **{name: self.spent.get(name, 0.0) for name in stages},
            total=time.monotonic() - self.started,
        )
