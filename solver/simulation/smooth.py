"""Smooth motions: DOP853 from corner to corner of what drives them, with its own interpolant.

The contacts of the system's ``mode`` and its loops hold by their accelerations: what they drift
is part of the error, and is seen in the gaps.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import scipy  # loads scipy.integrate, which takes long, when it is first asked for

from schemas.errors import InvalidModel, Issue
from schemas.expressions import Name
from schemas.pointers import pointer
from schemas.simulated import SimulationStatus
from schemas.simulations import Smooth
from solver.numeric.tape import Array
from solver.simulation.experiment import Experiment, Halt, Outcome, Stretch
from solver.simulation.multibody import Multibody
from solver.simulation.starts import open_loops, parting_loops
from solver.simulation.touch import Contacts

HELD = 1e-6
"""How far off, in m and m/s, what is held may be at the start."""

STILL = "what is held is zero at the start: change 'initial', or leave it out of the mode"
AHEAD = {"sliding_right": 1.0, "sliding_left": -1.0}

_SHOWN = 6
"""States that a message lists."""

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
        [_stretch(path, experiment.state)],
        status,
        message,
        forces=_forces(experiment),
        evaluations=path.evaluations,
        steps=len(path.curves),
    )


def _stretch(path: _Path, start: Array) -> Stretch:
    """The steps; where there is none, the start alone."""
    if path.curves:
        return Stretch(np.array(path.times), lambda step, t: path.curves[step](t))
    return Stretch(np.array(path.times), lambda _, t: np.repeat(start[:, None], len(t), axis=1))


def _check_start(experiment: Experiment) -> None:
    """What is held only by its acceleration has to be in place, and at rest, at the start."""
    plant = experiment.mechanism
    if plant is None:
        return
    model = plant.model
    at = model.at(experiment.start, *np.split(experiment.state, 2))
    issues = [
        *_contacts_off(model, at.contacts),
        *open_loops(model, at, experiment.simulation.initial, HELD),
    ]
    issues = issues or [*parting_loops(model, at, HELD)]
    if issues:
        raise InvalidModel(issues)


def _contacts_off(model: Multibody, touch: Contacts) -> Iterator[Issue]:
    """Contacts of the mode that are apart, or move as the mode does not say."""
    for name, doing in model.mechanism.mode.items():
        row = model.pairs.index(name)
        slip = float(touch.slips[row, 0])
        off = {
            "the gap of contact '{}', m": touch.gaps[row, 0],
            "the gap's rate of contact '{}', m/s": touch.gap_rates[row, 0],
            "the slip of contact '{}', m/s": slip if doing == "sticking" else 0.0,
        }
        for what, size in off.items():
            if not abs(size) <= HELD:
                message = f"{what.format(name)}, is {size:.3g} at the start"
                yield Issue("/initial", message, STILL)
        other = "sliding_left" if doing == "sliding_right" else "sliding_right"
        if doing in ("sliding_left", "sliding_right") and slip * AHEAD[doing] < -HELD:
            yield Issue(
                pointer("system", "mode", name),
                f"the contact '{name}' is {doing}, but its slip is {slip:.3g} m/s at the start",
                f"write '{other}', or the method 'events', which finds the mode by itself",
            )


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
            return state, (SimulationStatus.INVALID_NUMBER, no_rates(experiment, state, span[0]))
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
        return SimulationStatus.INVALID_NUMBER, no_rates(experiment, state, t)
    fastest = experiment.plant.states[int(np.argmax(np.abs(now)))]
    message = (
        f"The steps vanish at t = {t:.9g} s, where {fastest} changes by {np.abs(now).max():.3g}/s."
    )
    return SimulationStatus.DIVERGED, message


def no_rates(experiment: Experiment, state: Array, t: float) -> str:
    """Which rates have no value, where; the state says why, more often than not."""
    names = experiment.plant.states
    with np.errstate(all="ignore"):
        rates = experiment.rates(t, state, t)
    bad = [name for name, rate in zip(names, rates, strict=True) if not np.isfinite(rate)]
    if not bad:
        return f"The rates have no finite value at t = {t:.9g} s."
    shown = [f"{name} = {one:.6g}" for name, one in zip(names, state, strict=True)][:_SHOWN]
    more = ", ..." if len(names) > _SHOWN else ""
    which = " and ".join(bad[:3])
    return (
        f"The rate of {which} has no finite value at t = {t:.9g} s, where {', '.join(shown)}{more}."
    )


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
