"""One simulation, from the document to the result."""

import importlib.metadata
import platform
import time
from collections.abc import Callable
from dataclasses import replace

from schemas.events import Advanced, EngineEvent, StageStarted
from schemas.limits import MODEL_LIMITS
from schemas.reading import spec_sha256
from schemas.remarks import simulated_remarks
from schemas.results import Reproduce
from schemas.simulated import SimulationResult, SimulationStatus, SimulationTiming
from schemas.simulations import Simulation
from solver.simulation.events import events
from solver.simulation.experiment import Experiment, Halt, Outcome
from solver.simulation.results import energy_of, phase_result, sequence_of, thinning
from solver.simulation.smooth import smooth
from solver.simulation.time_stepping import time_stepping
from solver.simulation.unheeded import remarks, too_deep

METHODS: dict[str, Callable[[Experiment, Halt], Outcome]] = {
    "smooth": smooth,
    "events": events,
    "time_stepping": time_stepping,
}
"""Kind of method -> how it goes."""

_PAUSE = 0.2  # s between two events of progress
_PACKAGES = ("footfall-server", "numpy", "scipy")


def simulate(
    simulation: Simulation,
    on_event: Callable[[EngineEvent], None] = lambda _: None,
    deadline: float = float("inf"),
    should_stop: Callable[[], bool] = lambda: False,
) -> SimulationResult:
    """Simulate a system.

    Parameters
    ----------
    simulation
        As `schemas.simulations.read_simulation` made it.
    on_event
        Told of the stages, and of how far the motion is.
    deadline
        On the clock of ``time.monotonic``; past it the motion ends with status ``time_limit``.
    should_stop
        Asked after every step; then the status is ``cancelled``.

    Raises
    ------
    InvalidModel
        For what only the model can tell.
    """
    began = time.monotonic()
    on_event(StageStarted(stage="build"))
    experiment = Experiment.of(simulation)
    built = time.monotonic()
    on_event(StageStarted(stage="simulate"))
    last = min(deadline, began + simulation.limits.seconds)
    outcome = METHODS[simulation.method.kind](
        experiment, _watch(experiment, on_event, last, should_stop)
    )
    outcome = _judged(experiment, outcome)
    moved = time.monotonic()
    return SimulationResult(
        name=simulation.name,
        status=outcome.status,
        message=outcome.message or _message(experiment, outcome),
        advice=list(outcome.advice),
        warnings=[
            *simulated_remarks(simulation),
            *_warnings(outcome),
            *remarks(experiment, outcome),
        ],
        phases=[phase_result(experiment, outcome, simulation.samples)],
        events=list(outcome.events),
        mode_sequence=sequence_of(experiment, outcome),
        energy=energy_of(experiment, outcome),
        timing=SimulationTiming(
            build=built - began,
            simulate=moved - built,
            total=time.monotonic() - began,
            evaluations=outcome.evaluations,
            steps=outcome.steps,
        ),
        reproduce=Reproduce(spec_sha256=spec_sha256(simulation), versions=_versions()),
    )


def _judged(experiment: Experiment, outcome: Outcome) -> Outcome:
    """What went through the ground has not come to its end."""
    if outcome.status not in (SimulationStatus.FINISHED, SimulationStatus.STOPPED):
        return outcome
    found = too_deep(experiment, outcome)
    return outcome if found is None else replace(outcome, status=found[0], message=found[1])


def _watch(
    experiment: Experiment,
    on_event: Callable[[EngineEvent], None],
    deadline: float,
    should_stop: Callable[[], bool],
) -> Halt:
    told, steps = time.monotonic(), 0

    def halt(now: float, events: int) -> tuple[SimulationStatus, str] | None:
        nonlocal told, steps
        steps += 1
        clock = time.monotonic()
        if clock - told > _PAUSE:
            told = clock
            on_event(Advanced(time=now, end=experiment.end, events=events))
        if should_stop():
            return SimulationStatus.CANCELLED, f"Cancelled at t = {now:.6g} s."
        if clock >= deadline:
            return SimulationStatus.TIME_LIMIT, f"Out of time at t = {now:.6g} s of the motion."
        if steps >= MODEL_LIMITS.simulation_steps:
            words = f"{steps} steps, the most there may be, lead to t = {now:.6g} s of the motion."
            return SimulationStatus.STEP_LIMIT, words
        return None

    return halt


def _message(experiment: Experiment, outcome: Outcome) -> str:
    if not outcome.stretches:
        return "No step was taken."
    return f"{outcome.stretches[-1].times[-1] - experiment.start:.6g} s in {outcome.steps} steps."


def _warnings(outcome: Outcome) -> list[str]:
    stride = thinning(outcome)
    if stride == 1:
        return []
    return [f"The curves hold {stride} steps in each piece; the series are exact."]


def _versions() -> dict[str, str]:
    found = {name: importlib.metadata.version(name) for name in _PACKAGES}
    return {"python": platform.python_version(), **found}
