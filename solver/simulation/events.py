"""Simulation by events: of a mechanism's contacts and limits, and of guards that the user wrote."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel, Issue
from schemas.expressions import names_in
from schemas.pointers import pointer
from schemas.simulated import ModeSpan, SimulationStatus
from schemas.simulations import Events
from schemas.values import Scalar
from solver.numeric.tape import Array
from solver.simulation.automaton import Automaton, Moment, Stop
from solver.simulation.contact_automaton import ContactAutomaton
from solver.simulation.execution import execute
from solver.simulation.experiment import Experiment, Halt, Outcome, Stretch
from solver.simulation.guarded import Guarded, OneMode
from solver.simulation.held import OPEN, Touch, held
from solver.simulation.smooth import no_rates
from solver.simulation.spans import Execution, Settings, Span
from solver.simulation.unilateral import Unilateral, check_start

ADVICE = {
    SimulationStatus.ZENO: "Raise 'escape_velocity', or end the simulation by a terminal event.",
    SimulationStatus.PAINLEVE: "'time_stepping' goes through such states by an impulse.",
}


def events(experiment: Experiment, halt: Halt) -> Outcome:
    """Follow a system from event to event.

    Raises
    ------
    InvalidModel
        For a start in penetration or with open loops, and for guards on contact forces.
    """
    method = experiment.simulation.method
    chosen = method if isinstance(method, Events) else Events(kind="events")
    system = system_of(experiment, chosen.restitution)
    pieces = experiment.drive.pieces(experiment.start, experiment.end)
    inner: Automaton[Any] = OneMode(experiment)
    if system is not None:
        moment = Moment(pieces[0], experiment.state, (pieces[0] + pieces[1]) / 2)
        check_start(system, moment, experiment.simulation.initial)
        _check_guards(experiment)
        inner = ContactAutomaton.of(system, chosen.escape_velocity)
    automaton = Guarded.of(inner, experiment) if experiment.simulation.events else inner
    try:
        done = execute(automaton, experiment.state, pieces, _settings(chosen, system, halt))
    except np.linalg.LinAlgError:
        return _singular(experiment)
    if done.status is SimulationStatus.INVALID_NUMBER:
        done.message = no_rates(experiment, done.state, done.end)
    return _outcome(done, system)


def _singular(experiment: Experiment) -> Outcome:
    """No motion beyond the start, where the mass matrix becomes singular on the way."""
    start = experiment.state
    stretch = Stretch(
        np.array([experiment.start]), lambda _, t: np.repeat(start[:, None], len(t), axis=1)
    )
    message = "the masses are singular in a pose on the way: give every body an inertia"
    return Outcome([stretch], SimulationStatus.INVALID_NUMBER, message)


def system_of(experiment: Experiment, restitution: Scalar | None) -> Unilateral | None:
    """All that may touch, where the system is a mechanism."""
    plant = experiment.mechanism
    if plant is None:
        return None
    statics = plant.model.statics
    known = {**statics, **resolve.parameters(experiment.simulation.system)}
    bounce = None if restitution is None else resolve.scalar(restitution, known)
    return Unilateral.of(plant.model, experiment.drive, statics, bounce)


def _settings(method: Events, system: Unilateral | None, halt: Halt) -> Settings:
    def stopped(time: float, events: int) -> Stop | None:
        found = halt(time, events)
        return None if found is None else Stop(*found)

    return Settings(
        tolerance=method.tolerance,
        spacing=method.max_step,
        max_events=method.max_events,
        # Contacts have an escape velocity against accumulations; guards have nothing.
        shortest=1e-4 * method.max_step if system is None else 1e-12,
        halt=stopped,
    )


def _check_guards(experiment: Experiment) -> None:
    """Forces of contacts depend on the mode that the guards are to find."""
    for row, guard in enumerate(experiment.simulation.events):
        for name in names_in(guard.expression.tree):
            if name.name.startswith("contact.") and name.name.endswith(("normal", "tangential")):
                place = pointer("events", row, "expression")
                message = f"'{name.name}' is not known to a guard"
                hint = "lift-off and slipping are events by themselves; use gaps and slips"
                raise InvalidModel([Issue(place, message, hint, name.column)])


def _outcome(done: Execution, system: Unilateral | None) -> Outcome:
    advice = [ADVICE[done.status]] if done.status in ADVICE else []
    return Outcome(
        [_stretch(span) for span in done.spans],
        done.status,
        done.message,
        events=[event for record in done.records for event in record.events],
        modes=[] if system is None else mode_spans(done.spans, system.multibody.pairs),
        forces=None if system is None else forces_of(system),
        evaluations=done.evaluations,
        steps=done.steps,
        advice=advice,
    )


def _stretch(span: Span) -> Stretch:
    def states(step: int, times: Array) -> Array:
        if not span.curves:
            return np.repeat(span.first[:, None], len(times), axis=1)
        found = np.array(span.curves[step](times))
        found[:, times <= span.times[0]] = span.first[:, None]
        found[:, times >= span.times[-1]] = span.last[:, None]
        return found

    return Stretch(span.times, states, span.mode)


def mode_spans(spans: Sequence[Span], pairs: Sequence[str]) -> list[ModeSpan]:
    """Which contacts touch, and how; neighbours that do the same are one."""
    found: list[ModeSpan] = []
    for span in spans:
        words = zip(pairs, span.mode.doing, strict=False)  # limits come after the pairs
        contacts = {pair: word for pair, word in words if word != OPEN}
        start, end = float(span.times[0]), float(span.times[-1])
        if found and found[-1].contacts == contacts:
            start = found.pop().start
        found.append(ModeSpan(start=start, end=end, contacts=contacts))
    return found


def forces_of(
    system: Unilateral,
) -> Callable[[Stretch, Array, Array, Array], Mapping[str, Array]]:
    """The forces of contacts, limits and loops along a stretch, by name."""
    loops = system.multibody.parts.loop_names

    def forces(stretch: Stretch, t: Array, x: Array, u: Array) -> Mapping[str, Array]:
        mode: Touch = stretch.mode
        q, v = np.split(x, 2)
        at = system.multibody.at(t, q, v, u)
        found = held(system, mode, at, system.rows(at))
        named = {}
        for i, name in enumerate(system.names[: system.pairs]):
            named[f"contact.{name}.normal"] = found.normal[i]
            named[f"contact.{name}.tangential"] = found.tangential[i]
        for i, name in enumerate(system.names[system.pairs :], system.pairs):
            named[f"limit.{name}"] = found.normal[i]
        for i, name in enumerate(loops):
            named[f"loop.{name}.x"] = found.loops[i]
            named[f"loop.{name}.y"] = found.loops[len(loops) + i]
        return named

    return forces
