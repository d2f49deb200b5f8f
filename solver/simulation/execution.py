"""Runs a hybrid automaton: integrates each flow up to its first event, and jumps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import scipy  # loads scipy.integrate, which takes long, when it is first asked for
from numpy.typing import NDArray

from schemas.simulated import SimulationStatus
from solver.numeric.tape import Array
from solver.simulation.automaton import Automaton, Flow, Jump, Moment, Stop
from solver.simulation.guards import Sampling, first_crossing
from solver.simulation.spans import Execution, Record, Settings, Span

RESTLESS = 10
"""So many events in a row, each within ``shortest`` of the one before, accumulate."""

ROUND_OFF = 1e-10
"""A guard of this size starts on the side to which it moves."""


def execute(
    automaton: Automaton[Any], state: Array, pieces: Sequence[float], settings: Settings
) -> Execution:
    """Follow an automaton.

    Parameters
    ----------
    state
        To start from, (n,).
    pieces
        Times from the start to the end, between which what drives the automaton is smooth.
    settings
        Tolerances and limits.

    Returns
    -------
    An execution, whatever happens; its ``status`` says how it ended.
    """
    return _Executing(automaton, settings).run(state, pieces)


class _Executing:
    def __init__(self, automaton: Automaton[Any], settings: Settings) -> None:
        self.automaton, self.settings = automaton, settings
        self.done = Execution()
        self.jumps: list[float] = []

    def run(self, state: Array, pieces: Sequence[float]) -> Execution:
        middles = [(a + b) / 2 for a, b in pairwise(pieces)] or [pieces[0]]
        moment = Moment(pieces[0], state, middles[0])
        jump, stop = self._told(moment, self.automaton.begin(moment))
        above = None  # known where a mode goes on from piece to piece
        for within, end in zip(middles, pieces[1:], strict=False):
            while stop is None and moment.time < end:
                moment = Moment(moment.time, jump.state, within)
                smooth, stop = self._follow(jump.mode, moment, end, above)
                above = smooth.above
                moment = Moment(smooth.times[-1], smooth.last, within)
                jump = Jump(jump.mode, smooth.last)
                if smooth.fired and stop is None:
                    after = self.automaton.jump(jump.mode, smooth.fired, moment)
                    jump, stop = self._told(moment, after)
                    above = None
        if not self.done.spans or jump.state is not self.done.state:
            self._keep(_Smooth.at(jump.mode, moment.time, jump.state))
        if stop:
            self.done.status, self.done.message = stop
        return self.done

    def _told(self, moment: Moment, jump: Jump) -> tuple[Jump, Stop | None]:
        """Record a jump, and see whether it is the last."""
        if jump.records:
            self.done.records.append(Record(moment.time, moment.state, jump.state, jump.records))
        self.jumps.append(moment.time)
        return jump, jump.stop or self._restless()

    def _keep(self, smooth: "_Smooth") -> None:
        times = np.array(smooth.times)
        self.done.spans.append(Span(smooth.mode, times, smooth.curves, smooth.first, smooth.last))

    def _restless(self) -> Stop | None:
        times = self.jumps
        most = self.settings.max_events
        if len(times) - 1 > most:  # the start is the first of them
            message = f"more than {most} events, the last at t = {times[-1]:.9g} s"
            return Stop(SimulationStatus.ZENO, message)
        recent = np.diff(times[-RESTLESS - 1 :])
        if len(recent) == RESTLESS and np.all(recent < self.settings.shortest):
            return Stop(SimulationStatus.ZENO, f"events accumulate at t = {times[-1]:.9g} s")
        return None

    def _follow(
        self, mode: Any, moment: Moment, end: float, above: NDArray[np.bool_] | None
    ) -> tuple["_Smooth", Stop | None]:
        """One mode, up to its first event or the end of the piece."""
        flow = self.automaton.flow(mode, moment.within)
        smooth, stop = _Smooth.at(mode, moment.time, moment.state), None
        with np.errstate(all="ignore"):
            solver = self._solver(flow, moment, end)
            if not np.all(np.isfinite(solver.f)):
                message = f"the rates have no finite value at t = {moment.time:.9g} s"
                return smooth, Stop(SimulationStatus.INVALID_NUMBER, message)
            smooth.above = _sides(flow, moment.time, moment.state) if above is None else above
            while solver.status == "running" and not smooth.fired and stop is None:
                self._step(solver, flow, smooth)
                stop = self.settings.halt(smooth.times[-1], len(self.done.records))
        self.done.evaluations += solver.nfev
        self._keep(smooth)
        if solver.status == "failed":
            message = f"the integrator's steps vanish at t = {smooth.times[-1]:.9g} s"
            return smooth, Stop(SimulationStatus.DIVERGED, message)
        return smooth, stop

    def _solver(self, flow: Flow, moment: Moment, end: float) -> Any:
        tolerance = self.settings.tolerance
        return scipy.integrate.DOP853(
            flow.rates,
            moment.time,
            moment.state,
            end,
            rtol=tolerance,
            atol=tolerance / 100,
            first_step=min(self.settings.spacing, end - moment.time),
        )

    def _step(self, solver: Any, flow: Flow, smooth: "_Smooth") -> None:
        start, state = float(solver.t), solver.y
        solver.step()
        if solver.status == "failed" or smooth.above is None:
            return
        self.done.steps += 1
        curve = solver.dense_output()
        span = (start, float(solver.t))
        sampling = Sampling(self.settings.spacing, early=len(smooth.times) == 1)

        def guards(times: Array) -> Array:
            return flow.guards(times, curve(times))

        crossing, smooth.above = first_crossing(guards, span, smooth.above, sampling)
        time, last = span[1], solver.y
        if crossing is not None:
            time, last = self._sharpened(flow, (start, state), crossing.time, crossing.fired[0])
            smooth.fired = crossing.fired
        smooth.add(time, curve, last)

    def _sharpened(
        self, flow: Flow, start: tuple[float, Array], time: float, guard: int
    ) -> tuple[float, Array]:
        """Time and state of an event without the error of the interpolant.

        The integrator goes to the event itself; what the guard then misses of zero is mended by
        one step of Newton's method.
        """
        if time <= start[0]:
            return start
        solver = scipy.integrate.DOP853(
            flow.rates,
            *start,
            time,
            rtol=self.settings.tolerance,
            atol=self.settings.tolerance / 100,
            first_step=time - start[0],
        )
        while solver.status == "running":
            solver.step()
        if solver.status == "failed":
            return start
        self.done.evaluations += solver.nfev
        state, rates = solver.y, solver.f
        ahead = 1e-7 * (time - start[0])
        pair = np.array([time, time + ahead])
        value, next_value = flow.guards(pair, np.stack([state, state + ahead * rates], 1))[guard]
        slope = (next_value - value) / ahead
        later = -value / slope if slope < 0 else 0.0
        if not abs(later) <= 1e-6 * (time - start[0]):
            later = 0.0
        return time + later, np.asarray(state + later * rates)


@dataclass
class _Smooth:
    """A span in the making."""

    mode: Any
    times: list[float]
    curves: list[Callable[[Array], Array]]
    first: Array
    last: Array
    fired: tuple[int, ...] = ()
    above: NDArray[np.bool_] | None = None

    @classmethod
    def at(cls, mode: Any, time: float, state: Array) -> "_Smooth":
        return cls(mode, [time], [], state, state)

    def add(self, time: float, curve: Callable[[Array], Array], last: Array) -> None:
        self.times.append(time)
        self.curves.append(curve)
        self.last = last


def _sides(flow: Flow, time: float, state: Array) -> NDArray[np.bool_]:
    """On which side the guards start."""
    ahead = 1e-7
    rates = flow.rates(time + ahead / 2, state + ahead / 2 * flow.rates(time, state))
    states = np.stack([state, state + ahead * rates], 1)
    value, later = flow.guards(np.array([time, time + ahead]), states).T
    near = np.abs(value) <= ROUND_OFF
    return np.asarray(np.where(near, later > value, value > 0) | flow.armed, dtype=bool)
