"""The method ``time_stepping``: steps to the end, and what they tell of contacts."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from schemas.simulated import EventKind, ModeSpan, SimulationEvent, SimulationStatus
from schemas.simulations import TimeStepping
from solver.numeric.tape import Array
from solver.simulation.automaton import Moment
from solver.simulation.events import system_of
from solver.simulation.experiment import Experiment, Halt, Outcome, Stretch
from solver.simulation.held import CLOSED, FRICTIONLESS, LEFT, OPEN, RIGHT, STICKING
from solver.simulation.lcp import LcpStatus
from solver.simulation.stepping import Stepped, Stepper
from solver.simulation.unilateral import Unilateral, check_start

SLIDES = 1e-9
"""Slips above it are some, m/s."""

CONTRADICTION = "the contacts of the step from t = {:.9g} s contradict each other ({})"


@dataclass(slots=True)
class _Path:
    """The steps so far, and where they end."""

    times: list[float]
    states: list[Array]
    steps: list[Stepped] = field(default_factory=list)


def time_stepping(experiment: Experiment, halt: Halt) -> Outcome:
    """Follow a mechanism by steps.

    Raises
    ------
    InvalidModel
        For a start in penetration or with open loops.
    """
    method = experiment.simulation.method
    chosen = method if isinstance(method, TimeStepping) else TimeStepping(kind="time_stepping")
    system = system_of(experiment, chosen.restitution)
    if system is None:
        raise NotImplementedError  # the schema refuses other systems
    start, end = experiment.start, experiment.end
    moment = Moment(start, experiment.state, start + chosen.step / 2)
    check_start(system, moment, experiment.simulation.initial)
    path = _Path([start], [experiment.state])
    count = max(math.ceil((end - start) / chosen.step * (1 - 1e-12)), 1)
    stop = None
    for k in range(count):
        stop = _advance(system, path, min(start + (k + 1) * chosen.step, end))
        stop = stop or (halt(path.times[-1], 0) if k + 1 < count else None)
        if stop:
            break
    status, message = stop or (SimulationStatus.FINISHED, "")
    doing = _doing(system, path)
    return Outcome(
        [_stretch(path)],
        status,
        message,
        _events(system, path, doing),
        _modes(system, path, doing),
        degree=1,
        forces=_forces(system, path),
        evaluations=len(path.steps),
        steps=len(path.steps),
    )


def _advance(system: Unilateral, path: _Path, end: float) -> tuple[SimulationStatus, str] | None:
    """One step; or why there is none."""
    start = path.times[-1]
    stepper = Stepper(system).within((start + end) / 2)
    with np.errstate(all="ignore"):
        try:
            found = stepper.step(start, path.states[-1], end - start)
        except np.linalg.LinAlgError:
            return SimulationStatus.INVALID_NUMBER, f"singular masses at t = {start:.9g} s"
    if found.status is LcpStatus.INVALID_NUMBER or not np.all(np.isfinite(found.state)):
        return SimulationStatus.INVALID_NUMBER, f"no finite motion after t = {start:.9g} s"
    if found.status is not LcpStatus.SOLVED:
        return SimulationStatus.DIVERGED, CONTRADICTION.format(start, found.status)
    path.times.append(end)
    path.states.append(found.state)
    path.steps.append(found)
    return None


def _doing(system: Unilateral, path: _Path) -> list[list[str]]:
    """What every constraint did, step by step.

    A linearised gap may miss a touch by one step on a curved way: one step alone is no opening.
    """
    table = [[_word(system, one, i) for i in range(len(system.names))] for one in path.steps]
    for k in range(1, len(table) - 1):
        for i, word in enumerate(table[k]):
            if word == OPEN and OPEN not in (table[k - 1][i], table[k + 1][i]):
                table[k][i] = table[k - 1][i]
    return table


def _word(system: Unilateral, found: Stepped, i: int) -> str:
    """What a constraint did along a step."""
    if found.normal[i] <= 0:
        return OPEN
    if i >= system.pairs:
        return CLOSED
    if system.friction[i] == 0:
        return FRICTIONLESS
    if abs(found.slips[i]) <= SLIDES:
        return STICKING
    return RIGHT if found.slips[i] > 0 else LEFT


def _events(system: Unilateral, path: _Path, doing: list[list[str]]) -> list[SimulationEvent]:
    """Changes from step to step; the first step has none before it."""
    told = []
    for k in range(1, len(doing)):
        for i, (old, new) in enumerate(zip(doing[k - 1], doing[k], strict=True)):
            if old != new:
                told.append(_event(system, path, (k, i), old, new))
    return told


def _event(
    system: Unilateral, path: _Path, place: tuple[int, int], old: str, new: str
) -> SimulationEvent:
    step, i = place
    found, time, name = path.steps[step], path.times[step], system.names[i]
    if old != OPEN or not found.approach[i] < 0:
        return SimulationEvent(time=time, kind=_kind(old, new), name=name)
    return SimulationEvent(
        time=time,
        kind="impact",
        name=name,
        normal=float(found.normal[i]),
        tangential=float(found.tangential[i]),
        gap_rate=(float(found.approach[i]), float(found.gap_rates[i])),
    )


def _kind(old: str, new: str) -> EventKind:
    if new == OPEN:
        return "lift"
    if old == OPEN:
        return "touch"
    return "stick" if new == STICKING else "slip"


def _stretch(path: _Path) -> Stretch:
    """Straight lines between the ends of the steps."""
    times, table = np.array(path.times), np.array(path.states).T

    def states(step: int, at: Array) -> Array:
        if len(times) == 1:
            return np.repeat(table, len(at), axis=1)
        share = (at - times[step]) / (times[step + 1] - times[step])
        return np.asarray(table[:, step, None] * (1 - share) + table[:, step + 1, None] * share)

    return Stretch(times, states)


def _modes(system: Unilateral, path: _Path, doing: list[list[str]]) -> list[ModeSpan]:
    spans: list[ModeSpan] = []
    for step, words in enumerate(doing):
        named = zip(system.names[: system.pairs], words, strict=False)
        contacts = {name: word for name, word in named if word != OPEN}
        start, end = path.times[step : step + 2]
        if spans and spans[-1].contacts == contacts:
            start = spans.pop().start
        spans.append(ModeSpan(start=start, end=end, contacts=contacts))
    return spans


def _forces(
    system: Unilateral, path: _Path
) -> Callable[[Stretch, Array, Array, Array], Mapping[str, Array]] | None:
    """Impulses over the length of their steps: an impact shows as a large force for one step."""
    if not path.steps:
        return None
    lengths = np.diff(path.times)
    normal = np.array([one.normal for one in path.steps]).T / lengths
    tangential = np.array([one.tangential for one in path.steps]).T / lengths

    def forces(stretch: Stretch, t: Array, _: Array, __: Array) -> Mapping[str, Array]:
        steps = np.searchsorted(stretch.times, t, side="right") - 1
        steps = np.clip(steps, 0, len(lengths) - 1)
        named = {}
        for i, name in enumerate(system.names):
            if i < system.pairs:
                named[f"contact.{name}.normal"] = normal[i, steps]
                named[f"contact.{name}.tangential"] = tangential[i, steps]
            else:
                named[f"limit.{name}"] = normal[i, steps]
        return named

    return forces
