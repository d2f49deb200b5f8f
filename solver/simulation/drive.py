"""What steers a simulation: controls over time, feedback, and where they have corners."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy  # loads scipy.interpolate, which takes long, when it is first asked for
from numpy.polynomial import chebyshev

from footfall.curves import Curve, fit
from schemas.errors import Issue
from schemas.pointers import Part, pointer
from schemas.simulations import (
    ExpressionSignal,
    Feedback,
    GainSchedule,
    SampledSignal,
    Signal,
    Simulation,
    SolutionSignal,
)
from solver.numeric.tape import Array
from solver.simulation.plant import Evaluate, Plant

DEGREES = {"hold": 0, "linear": 1, "cubic": 3}

Series = Callable[[Array, Array, float], Array]
"""Times (N,), states (states, N) and a time within their piece -> one row for each name."""


@dataclass(frozen=True, slots=True)
class Drive:
    """The controls of a simulation: ``u = reference - K (x - x_ref)``.

    Between two neighbouring ``breaks`` everything is smooth. The integrator's last look at a piece
    is at its end, where the next one begins: so a time *within* the piece says which is meant.
    """

    plant: Plant
    series: Series
    feedback: "Gains | None" = None
    breaks: tuple[float, ...] = ()

    @classmethod
    def of(cls, simulation: Simulation, plant: Plant) -> "Drive":
        """Read controls and feedback. Raises InvalidModel for names without value."""
        signals = [simulation.controls]
        series = _series(simulation.controls, plant.controls, plant)
        gains = None
        if simulation.feedback is not None:
            gains = Gains.of(simulation.feedback, simulation.controls, plant)
            signals.append(simulation.feedback.reference)
        breaks = {one for signal in signals for one in _breaks(signal)}
        if simulation.feedback is not None and simulation.feedback.schedule is not None:
            breaks |= set(simulation.feedback.schedule.time)
        return cls(plant, series, gains, tuple(sorted(breaks)))

    def __call__(self, t: Array, x: Array, within: float) -> Array:
        """Controls (controls, N) at times (N,) and states (states, N) of one piece."""
        u = self.series(t, x, within)
        return u if self.feedback is None else u - self.feedback(t, x, within)

    def pieces(self, start: float, end: float) -> list[float]:
        """The times from ``start`` to ``end`` between which all is smooth, both included."""
        return [start, *(one for one in self.breaks if start < one < end), end]


@dataclass(frozen=True, slots=True)
class Gains:
    """``K (x - x_ref)``. ``gains`` gives the rows of ``places`` (control, state)."""

    places: tuple[tuple[int, int], ...]
    gains: Series
    reference: Series
    controls: int

    @classmethod
    def of(cls, feedback: Feedback, controls: Signal | None, plant: Plant) -> "Gains":
        """Read gains and reference."""
        reference = feedback.reference
        if reference is None and isinstance(controls, SolutionSignal):
            reference = controls
        states, names = list(plant.states), list(plant.controls)
        if feedback.schedule is not None:
            places = [(u, x) for u, row in feedback.schedule.gains.items() for x in row]
            gains = _scheduled(feedback.schedule)
        else:
            given = feedback.gains or {}
            places = [(u, x) for u, row in given.items() for x in row]
            trees = [given[u][x].tree for u, x in places]
            gains = _formulas(plant.evaluator(trees), len(names))
        rows = tuple((names.index(u), states.index(x)) for u, x in places)
        return cls(rows, gains, _series(reference, states, plant), len(names))

    def __call__(self, t: Array, x: Array, within: float) -> Array:
        """What the feedback takes away from the controls, (controls, N)."""
        gains, off = self.gains(t, x, within), x - self.reference(t, x, within)
        total = np.zeros((self.controls, x.shape[1]))
        for (control, state), gain in zip(self.places, gains, strict=True):
            total[control] += gain * off[state]
        return total


@dataclass(frozen=True, slots=True)
class Played:
    """Piecewise polynomials over time; before and after them their end values stay."""

    curves: Sequence[Curve | None] = field(default_factory=list)

    def __call__(self, t: Array, _: Array, within: float) -> Array:
        """One row for each curve; zero for None."""
        rows = np.zeros((len(self.curves), len(t)))
        for row, curve in zip(rows, self.curves, strict=True):
            if curve is not None:
                row[:] = _polynomial(curve, t, within)
        return rows


def _polynomial(curve: Curve, t: Array, within: float) -> Array:
    breaks = curve.breaks
    if within <= breaks[0] or within >= breaks[-1]:
        early = within <= breaks[0]
        value = chebyshev.chebval(-1.0 if early else 1.0, curve.coefficients[0 if early else -1])
        return np.full(len(t), value)
    k = int(np.searchsorted(breaks, within, side="right")) - 1
    s = 2 * (t - breaks[k]) / (breaks[k + 1] - breaks[k]) - 1
    return np.asarray(chebyshev.chebval(s, curve.coefficients[k]))


def _formulas(evaluate: Evaluate, controls: int) -> Series:
    """Formulas see no controls; these are not known yet."""

    def series(t: Array, x: Array, _: float) -> Array:
        return evaluate(t, x, np.full((controls, len(t)), np.nan))

    return series


def _series(signal: Signal | None, names: Sequence[str], plant: Plant) -> Series:
    """A signal's values for names, zero for those that it leaves out."""
    match signal:
        case ExpressionSignal():
            return _expressions(signal, names, plant)
        case SampledSignal():
            time, kind = np.array(signal.time), signal.interpolation
            given = signal.values
            return Played(
                [_through(time, given[name], kind) if name in given else None for name in names]
            )
        case SolutionSignal():
            return Played([_played(signal, name) for name in names])
        case None:
            return Played([None] * len(names))


def _expressions(signal: ExpressionSignal, names: Sequence[str], plant: Plant) -> Series:
    given = [name for name in names if name in signal.values]
    evaluate = plant.evaluator([signal.values[name].tree for name in given])
    inner = _formulas(evaluate, len(plant.controls))
    rows = [list(names).index(name) for name in given]

    def series(t: Array, x: Array, within: float) -> Array:
        values = np.zeros((len(names), len(t)))
        values[rows] = inner(t, x, within)
        return values

    return series


def _scheduled(schedule: GainSchedule) -> Series:
    time = np.array(schedule.time)
    return Played(
        [
            _through(time, values, "linear")
            for row in schedule.gains.values()
            for values in row.values()
        ]
    )


def _through(time: Array, values: Sequence[float], kind: str) -> Curve:
    """The interpolant of samples, segment by segment."""
    given, degree = np.array(values, dtype=float), DEGREES[kind]
    if degree == 0:  # a last segment without a length holds the last value
        return Curve([*time, time[-1]], given[:, None])
    nodes = np.linspace(-1.0, 1.0, degree + 1)
    places = time[:-1, None] + np.diff(time)[:, None] * (nodes + 1) / 2
    if degree == 1 or len(time) == 2:
        table = np.interp(places, time, given)
    else:
        table = scipy.interpolate.CubicSpline(time, given)(places)
    return Curve(time, fit(nodes, table[:, :, None])[0])


def _played(signal: SolutionSignal, name: str) -> Curve | None:
    """The curves of all phases in a row, as one."""
    found = []
    for phase in signal.phases:
        groups = [group for group in phase.curves.values() if name in group.coefficients]
        if groups:
            rows = [[one or 0.0 for one in row] for row in groups[0].coefficients[name]]
            found.append(Curve(groups[0].breaks, rows))
    if not found:
        return None
    terms = 1 + max(curve.degree for curve in found)
    padded = [np.pad(c.coefficients, ((0, 0), (0, terms - 1 - c.degree))) for c in found]
    breaks = np.concatenate([found[0].breaks[:1], *(curve.breaks[1:] for curve in found)])
    return Curve(breaks, np.concatenate(padded))


def _breaks(signal: Signal | None) -> set[float]:
    if isinstance(signal, SampledSignal):
        return set(signal.time)
    if isinstance(signal, SolutionSignal):
        groups = [group for phase in signal.phases for group in phase.curves.values()]
        return {one for group in groups for one in group.breaks}
    return set()


def circular(simulation: Simulation, plant: Plant, t: Array, x: Array) -> Issue | None:
    """A formula of a control that depends on controls, by way of a rate or a force.

    It has no value while the controls have none, at (1,) time and state (states, 1), though it
    would have one otherwise.
    """
    places: list[tuple[tuple[Part, ...], Signal | None]] = [(("controls",), simulation.controls)]
    if simulation.feedback is not None:
        places.append((("feedback", "reference"), simulation.feedback.reference))
    for root, signal in places:
        for name, formula in signal.values.items() if isinstance(signal, ExpressionSignal) else ():
            evaluate = plant.evaluator([formula.tree])
            values = [evaluate(t, x, np.full((len(plant.controls), 1), u)) for u in (np.nan, 0.0)]
            if np.isnan(values[0][0, 0]) and np.isfinite(values[1][0, 0]):
                hint = "rates and forces follow from the controls; use states and places"
                place = pointer(*root, "values", name)
                return Issue(place, f"the formula of '{name}' depends on the controls", hint)
    return None
