"""The published curves of a phase, segment by segment, so that both limits of a break are seen."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from footfall.curves import Curve, fit
from schemas.results import PhaseResult
from solver.lowering.form import Form
from solver.numeric.tape import Array

Index = NDArray[np.intp]

GROUPS = ("states", "controls", "rates")
"""Where the series of a motion are: a control whose derivatives are used is a state of its form,
and is published among the controls all the same. So a series is found by its name."""


class MalformedCurves(ValueError):
    """The curves of a result cannot be read; the message says which and why."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Chebyshev coefficients of some series, shape (series, segments, degree + 1)."""

    coefficients: Array

    def grid(self, s: Array) -> Array:
        """Values (series, segments, points) at the same places s (points,) in every segment."""
        basis = chebyshev.chebvander(s, self.coefficients.shape[2] - 1)
        return np.asarray(self.coefficients @ basis.T, dtype=np.float64)

    def at(self, segment: Index, s: Array) -> Array:
        """Values (series, n) at places s (n,) in [-1, 1], each in its own segment (n,)."""
        coefficients = self.coefficients[:, segment].transpose(2, 0, 1)
        return np.asarray(chebyshev.chebval(s, coefficients, tensor=False), dtype=np.float64)

    def slopes(self) -> "Pieces":
        """The derivatives with respect to s."""
        return Pieces(np.asarray(chebyshev.chebder(self.coefficients, axis=2), dtype=np.float64))


@dataclass(frozen=True, slots=True)
class Samples:
    """Points of a phase: time (n,), states (n_x, n), controls (n_u, n)."""

    t: Array
    x: Array
    u: Array


@dataclass(frozen=True, slots=True)
class PhaseCurves:
    """States and controls over the segments between ``breaks`` (segments + 1,), in seconds."""

    breaks: Array
    states: Pieces
    controls: Pieces

    @classmethod
    def read(cls, form: Form, result: PhaseResult) -> Self:
        """The curves of a form's states and controls, on the union of all their breaks.

        Raises
        ------
        MalformedCurves
            If a series is missing, its pieces do not fit the breaks, or the spans differ.
        """
        names = [*form.states, *form.controls]
        curves = _curves(result, names)
        breaks = curves[0].breaks
        for curve in curves[1:]:
            if np.array_equal(curve.breaks, breaks):
                continue
            if not np.allclose(curve.domain, breaks[[0, -1]], rtol=1e-12, atol=1e-12):
                raise MalformedCurves(f"{' and '.join(names)} are not over the same span of time")
            inner = curve.breaks[(curve.breaks > breaks[0]) & (curve.breaks < breaks[-1])]
            breaks = np.union1d(breaks, inner)
        states, controls = curves[: len(form.states)], curves[len(form.states) :]
        return cls(breaks, _pieces(states, breaks), _pieces(controls, breaks))

    @property
    def segments(self) -> int:
        """The number of segments."""
        return len(self.breaks) - 1

    @property
    def lengths(self) -> Array:
        """The segments' lengths in seconds, (segments,)."""
        return np.diff(self.breaks)

    def time(self, segment: Index, s: Array | float) -> Array:
        """The times of places s in [-1, 1] of segments; the two are broadcast."""
        return np.asarray(self.breaks[segment] + self.lengths[segment] * (s + 1) / 2)

    def grid(self, s: Array) -> Samples:
        """The same places s (points,) in every segment, flat: n = segments * points."""
        t = self.time(np.arange(self.segments)[:, None], s)
        x, u = (
            values.reshape(len(values), t.size)
            for values in (self.states.grid(s), self.controls.grid(s))
        )
        return Samples(t.ravel(), x, u)

    def knots(self) -> Array:
        """The states at the breaks, (states, segments + 1): where each segment starts, the end."""
        ends = self.states.grid(np.array([-1.0, 1.0]))
        return np.concatenate([ends[:, :, 0], ends[:, -1:, 1]], axis=1)

    def at(self, segment: Index, s: Array) -> Samples:
        """Places s (n,), each in its own segment (n,)."""
        x, u = self.states.at(segment, s), self.controls.at(segment, s)
        return Samples(self.time(segment, s), x, u)


def _curves(result: PhaseResult, names: Sequence[str]) -> list[Curve]:
    """The series of these names, each from the group that has it."""
    groups = [result.curves[label] for label in GROUPS if label in result.curves]
    homes = {name: group for group in groups for name in group.coefficients}
    if missing := [name for name in names if name not in homes]:
        raise MalformedCurves(f"there is no curve of {', '.join(missing)}")
    try:
        return [
            Curve(homes[name].breaks, np.array(homes[name].coefficients[name], dtype=float))
            for name in names
        ]
    except ValueError as error:
        raise MalformedCurves(f"the curves cannot be read: {error}") from error


def _pieces(curves: Sequence[Curve], breaks: Array) -> Pieces:
    """Series padded to one degree, on their own breaks or on finer ones."""
    terms = max((curve.degree for curve in curves), default=0) + 1
    rows = np.zeros((len(curves), len(breaks) - 1, terms))
    nodes = chebyshev.chebpts1(terms)
    for row, curve in zip(rows, curves, strict=True):
        if np.array_equal(curve.breaks, breaks):
            row[:, : curve.degree + 1] = curve.coefficients
        else:
            times = breaks[:-1, None] + np.diff(breaks)[:, None] * (nodes + 1) / 2
            row[:] = fit(nodes, curve(times)[:, :, None])[0]
    return Pieces(rows)
