"""Controls that rest on a limit or at zero on one side of a switch."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from schemas import resolve
from schemas.expressions import Name
from schemas.phases import Phase
from solver.numeric import Array
from solver.switches.samples import PLACES, Samples

RESTS = 1e-3
"""How near to its value a control rests, relative to its range."""


@dataclass(frozen=True, slots=True)
class Hold:
    """The values at which controls rest ``before`` and ``after`` a switch, by name."""

    before: Mapping[str, float] = field(default_factory=dict)
    after: Mapping[str, float] = field(default_factory=dict)


def holds(phase: Phase, samples: Samples, times: Sequence[float]) -> tuple[Hold, ...]:
    """What rests around each of the switches at ``times``.

    The value of a control at the very switch has no influence on the motion: where its limits
    decide on it, the switching function is zero there. In a quadrature with a node at the switch
    nothing would decide on that value, and the control between nodes would follow it astray. So
    where a control rests all along from one switch to the next (a segment at each end aside),
    its value at their ends is told.

    Controls whose derivatives are used are states of the form; they do not jump, and are free.
    """
    arcs = np.array([samples.knots[0], *times, samples.knots[-1]])
    rests: list[dict[str, float]] = [{} for _ in arcs[1:]]
    for name in phase.system.control_names:
        if name not in samples.form.controls:
            continue
        values = samples.value(Name(name))
        limits = resolve.interval(phase.bounds.get(name), samples.form.constants)
        for rest, start, end in zip(rests, arcs[:-1], arcs[1:], strict=True):
            value = _rest(samples, values, limits, start, end)
            if value is not None:
                rest[name] = value
    return tuple(Hold(before, after) for before, after in itertools.pairwise(rests))


def _rest(
    samples: Samples, values: Array, limits: tuple[float, float], start: float, end: float
) -> float | None:
    """The limit, or the zero, at which a control is from ``start`` to ``end``."""
    inside = np.flatnonzero((samples.t.ravel() > start) & (samples.t.ravel() < end))
    kept = inside[PLACES:-PLACES] if len(inside) > 2 * PLACES else inside[len(inside) // 2 :][:1]
    own = values.ravel()[kept]
    close = RESTS * float(np.ptp(values))
    for value in (*limits, 0.0):
        if len(own) and np.isfinite(value) and np.all(np.abs(own - value) <= close):
            return value
    return None
