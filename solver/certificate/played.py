"""Where the motion goes by an independent simulator, under the published controls alone.

Time stepping with linearised gaps and a linear complementarity problem a step
(``solver.simulation.stepping``).
"""

import math
import time
from dataclasses import dataclass

import numpy as np

from solver.certificate.steps import Steps
from solver.numeric import Array
from solver.simulation.lcp import LcpStatus
from solver.simulation.stepping import Stepper
from solver.simulation.unilateral import Unilateral

FINER = 10
"""Parts of a step in the second replay."""

SECONDS = 3.0
"""Of the clock, for one replay; then as far as it came."""


WILD = 1e3
"""m, rad or a second of it: what gets there has left all that could be compared."""


@dataclass(frozen=True, slots=True)
class Replay:
    """Coordinates at the knots that were reached, (n, M), and why no further."""

    q: Array
    ended: str = ""


def replay(steps: Steps, parts: int, until: float = math.inf) -> Replay:
    """Follow the published controls from the first knot.

    Parameters
    ----------
    parts
        Into so many each step is cut.
    until
        When to end, in seconds of ``time.monotonic``.
    """
    told, lengths = steps.published, steps.lengths

    def control(t: Array, _: Array, within: float) -> Array:
        step = int(np.searchsorted(told.knots, within, side="right")) - 1
        column = told.u[:, min(max(step, 0), len(lengths) - 1)]
        return np.repeat(column[:, None], len(t), axis=1)

    system = Unilateral.of(steps.model, control, steps.model.statics, restitution=0.0)
    state, path = np.concatenate([told.q, told.v])[:, 0], [told.q[:, 0]]
    for start, h in zip(told.knots, lengths, strict=False):
        for part in range(parts):
            if time.monotonic() > until:
                return Replay(np.array(path).T, f"out of time at t = {start:.6g} s")
            begun = start + part * h / parts
            stepper = Stepper(system).within(begun + h / parts / 2)
            try:
                found = stepper.step(begun, state, h / parts)
            except np.linalg.LinAlgError:
                return Replay(np.array(path).T, f"singular masses at t = {begun:.6g} s")
            if found.status is not LcpStatus.SOLVED or not np.all(np.isfinite(found.state)):
                return Replay(np.array(path).T, f"no way on at t = {begun:.6g} s")
            state = found.state
            if np.max(np.abs(state)) > WILD:
                return Replay(np.array(path).T, f"wild at t = {begun:.6g} s")
        path.append(state[: len(told.q)])
    return Replay(np.array(path).T)
