"""Events that the user declares, on top of any automaton; and one of a single mode."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from schemas.expressions import Tree
from schemas.simulated import SimulationEvent, SimulationStatus
from schemas.simulations import Guard
from solver.numeric.tape import Array
from solver.simulation.automaton import Automaton, Flow, Jump, Moment, Stop
from solver.simulation.experiment import Experiment

SIGNS = {"falling": (1.0,), "rising": (-1.0,), "both": (1.0, -1.0)}
"""Direction -> the factors with which a guard's value falls through zero."""

Look = Callable[[Array, Array, float], Array]
"""Times (k,), states (n, k), a time within their piece -> one row for each expression."""


@dataclass(frozen=True, slots=True)
class OneMode:
    """A system without modes of its own."""

    experiment: Experiment

    def begin(self, moment: Moment) -> Jump:
        """It just goes."""
        return Jump(None, moment.state)

    def flow(self, mode: None, within: float) -> Flow:  # noqa: ARG002 (there is but one)
        """The system's rates, and no guard."""
        return Flow(
            lambda t, x: self.experiment.rates(t, x, within),
            lambda times, _: np.zeros((0, len(times))),
            np.zeros(0, dtype=bool),
        )

    def jump(self, mode: None, fired: tuple[int, ...], moment: Moment) -> Jump:
        """Nothing fires."""
        raise NotImplementedError


@dataclass(frozen=True, slots=True)
class Guarded:
    """An automaton with guards of the user.

    Attributes
    ----------
    values
        Of the guards' expressions.
    resets
        For each guard the rows of the states that it sets, and their new values.
    """

    inner: Automaton[Any]
    guards: Sequence[Guard]
    values: Look
    resets: Sequence[tuple[list[int], Look]]

    @classmethod
    def of(cls, inner: Automaton[Any], experiment: Experiment) -> "Guarded":
        """With the events of a simulation. Raises InvalidModel for names without value."""
        guards, states = experiment.simulation.events, list(experiment.plant.states)
        resets = [
            (
                [states.index(name) for name in guard.reset],
                _looking(experiment, [one.tree for one in guard.reset.values()]),
            )
            for guard in guards
        ]
        values = _looking(experiment, [guard.expression.tree for guard in guards])
        return cls(inner, guards, values, resets)

    def begin(self, moment: Moment) -> Jump:
        """As the automaton itself."""
        return self.inner.begin(moment)

    def flow(self, mode: Any, within: float) -> Flow:
        """The automaton's guards, then the user's: two of one that counts both ways."""
        flow = self.inner.flow(mode, within)
        rows, signs = self._rows()

        def guards(times: Array, states: Array) -> Array:
            own = self.values(times, states, within)[rows] * signs[:, None]
            return np.concatenate([flow.guards(times, states), own])

        armed = np.concatenate([flow.armed, np.zeros(len(rows), dtype=bool)])
        return Flow(flow.rates, guards, armed)

    def jump(self, mode: Any, fired: tuple[int, ...], moment: Moment) -> Jump:
        """What the automaton does, then what the user's events ask for."""
        count = len(self.inner.flow(mode, moment.within).armed)
        rows, _ = self._rows()
        inner = tuple(one for one in fired if one < count)
        own = dict.fromkeys(int(rows[one - count]) for one in fired if one >= count)
        jump = Jump(mode, moment.state)
        if inner:
            jump = self.inner.jump(mode, inner, moment)
        for guard in own if jump.stop is None else ():
            jump = self._fire(guard, jump, moment)
        return jump

    def _fire(self, row: int, before: Jump, moment: Moment) -> Jump:
        guard, (states, values) = self.guards[row], self.resets[row]
        told = SimulationEvent(time=moment.time, kind="guard", name=guard.name)
        records = (*before.records, told)
        after = Jump(before.mode, before.state, records)
        if states:
            state = before.state.copy()
            now = np.array([moment.time])
            state[states] = values(now, before.state[:, None], moment.within)[:, 0]
            settled = self.inner.begin(Moment(moment.time, state, moment.within))
            after = Jump(settled.mode, settled.state, (*records, *settled.records), settled.stop)
        if guard.terminal:
            message = f"'{guard.name}' at t = {moment.time:.9g} s"
            after = Jump(after.mode, after.state, after.records, _stopped(message))
        return after

    def _rows(self) -> tuple[Array, Array]:
        pairs = [(k, sign) for k, g in enumerate(self.guards) for sign in SIGNS[g.direction]]
        return np.array([k for k, _ in pairs], dtype=int), np.array([sign for _, sign in pairs])


def _stopped(message: str) -> Stop:
    return Stop(SimulationStatus.STOPPED, message)


def _looking(experiment: Experiment, trees: Sequence[Tree]) -> Look:
    evaluate = experiment.plant.evaluator(trees)

    def look(times: Array, states: Array, within: float) -> Array:
        return evaluate(times, states, experiment.drive(times, states, within))

    return look
