"""Smooth motions: DOP853 from corner to corner of what drives them, with its own interpolant.

The contacts of the system's ``mode`` and its loops hold by their accelerations: what they drift
is part of the error, and is seen in the gaps.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import scipy  # loads scipy.integrate, which takes long, when it is first asked for

from schemas.errors import InvalidModel, Issue
from schemas.expressions import Name
from schemas.simulated import SimulationStatus
from schemas.simulations import Smooth
from solver.numeric.tape import Array
from solver.simulation.experiment import Experiment, Halt, Outcome, Stretch

HELD = 1e-6
"""How far off, in m and m/s, what is held may be at the start."""

Dense = Callable[[Array], Array]


@dataclass(slots=True)
class _Path:
    """The steps so far."""

    times: list[float]
    curves: list[Dense] = field(default_factory=list)
    evaluations: int = 0


def smooth(experiment: Experiment, halt: Halt) -> Outcome:
    """Follow a system without events to the end of its time, or to where it can go no further.

    Raises
    ------
    InvalidModel
        For a start at which contacts of the mode are apart or moving, or loops open.
    """
    _check_start(experiment)
    path = _Path([experiment.start])
    state, stop = experiment.state, None
    for span in pairwise(experiment.drive.pieces(experiment.start, experiment.end)):
        state, stop = _piece(experiment, state, span, path, halt)
        if stop:
            break
    status, message = stop or (SimulationStatus.FINISHED, "")
    return Outcome(
        [Stretch(np.array(path.times), lambda step, t: path.curves[step](t))]
        if path.curves
        else [],
        status,
        message,
        forces=_forces(experiment),
        evaluations=path.evaluations,
        steps=len(path.curves),
    )


def _check_start(experiment: Experiment) -> None:
    """What is held only by its acceleration has to be in place, and at rest, at the start."""
    plant = experiment.mechanism
    if plant is None:
        return
    model = plant.model
    q, v = np.split(experiment.state, 2)
    at = model.at(experiment.start, q, v)
    off: dict[str, float] = {}
    for name, doing in model.mechanism.mode.items():
        row, touch = model.pairs.index(name), at.contacts
        off[f"the gap of contact '{name}', m"] = touch.gaps[row, 0]
        off[f"the gap's rate of contact '{name}', m/s"] = touch.gap_rates[row, 0]
        if doing == "sticking":
            off[f"the slip of contact '{name}', m/s"] = touch.slips[row, 0]
    for row, name in enumerate(model.mechanism.loops):
        off[f"the opening of loop '{name}', m"] = abs(at.loops.z[row, 0])
        off[f"the opening of loop '{name}', m/s"] = abs(at.loops.rate[row, 0])
    hint = "what is held is zero at the start: change 'initial', or leave it out of the mode"
    issues = [
        Issue("/initial", f"{what}, is {size:.3g} at the start", hint)
        for what, size in off.items()
        if not abs(size) <= HELD
    ]
    if issues:
        raise InvalidModel(issues)


def _piece(
    experiment: Experiment, state: Array, span: tuple[float, float], path: _Path, halt: Halt
) -> tuple[Array, tuple[SimulationStatus, str] | None]:
    """Integrate where all is smooth."""
    method = experiment.simulation.method
    settings = method if isinstance(method, Smooth) else Smooth()
    within = sum(span) / 2

    def rates(t: float, x: Array) -> Array:
        return experiment.rates(t, x, within)

    with np.errstate(all="ignore"):
        first = rates(span[0], state)
        if not np.all(np.isfinite(first)):
            return state, (SimulationStatus.INVALID_NUMBER, _where(experiment, first, span[0]))
        solver = scipy.integrate.DOP853(
            rates,
            span[0],
            state,
            span[1],
            rtol=settings.tolerance,
            atol=settings.tolerance / 100,
            max_step=settings.max_step or np.inf,
        )
        stop = None
        while solver.status == "running" and stop is None:
            solver.step()
            if solver.status == "failed":
                stop = _failed(experiment, solver.y, float(solver.t), rates)
                break
            path.times.append(float(solver.t))
            path.curves.append(solver.dense_output())
            stop = halt(float(solver.t), 0) if solver.status == "running" else None
    path.evaluations += solver.nfev
    return solver.y, stop


def _failed(
    experiment: Experiment, state: Array, t: float, rates: Callable[[float, Array], Array]
) -> tuple[SimulationStatus, str]:
    """The steps have become as small as numbers go: why, as far as one can see."""
    now = rates(t, state)
    if not np.all(np.isfinite(now)):
        return SimulationStatus.INVALID_NUMBER, _where(experiment, now, t)
    fastest = experiment.plant.states[int(np.argmax(np.abs(now)))]
    message = (
        f"The steps vanish at t = {t:.9g} s, where {fastest} changes by {np.abs(now).max():.3g}/s."
    )
    return SimulationStatus.DIVERGED, message


def _where(experiment: Experiment, rates: Array, t: float) -> str:
    names = experiment.plant.states
    bad = [name for name, rate in zip(names, rates, strict=True) if not np.isfinite(rate)]
    return f"The rate of {' and '.join(bad[:3])} has no finite value at t = {t:.9g} s."


def _forces(
    experiment: Experiment,
) -> Callable[[Stretch, Array, Array, Array], Mapping[str, Array]] | None:
    """The forces of the contacts in the mode, and of the loops."""
    plant = experiment.mechanism
    if plant is None:
        return None
    mechanism = plant.model.mechanism
    names: Sequence[str] = [
        *(f"contact.{pair}.{w}" for pair in mechanism.mode for w in ("normal", "tangential")),
        *(f"loop.{loop}.{side}" for loop in mechanism.loops for side in ("x", "y")),
    ]
    evaluate = plant.evaluator([Name(name) for name in names])

    def forces(_: Stretch, t: Array, x: Array, u: Array) -> Mapping[str, Array]:
        return dict(zip(names, evaluate(t, x, u), strict=True))

    return forces if names else None
