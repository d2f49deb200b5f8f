"""What a motion went through that its method does not heed, and when it did so first.

``smooth`` keeps contacts as its mode says, whatever their forces, and knows no others; no method
limits motors.
"""

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from schemas import resolve
from schemas.simulated import SimulationStatus
from schemas.simulations import Smooth
from solver.numeric.tape import Array
from solver.simulation.experiment import Experiment, Outcome
from solver.simulation.multibody import Multibody
from solver.simulation.results import along
from solver.simulation.unilateral import Unilateral

DEPTH = 1e-3
"""A motion with a contact or limit deeper than this is not finished, m or rad."""

SLIGHT = 1e-6
"""Gaps, limits and slips count from here on: m, rad, m/s; and forces by their share."""

MOST_LOOKS = 20_000
EVENTS = "the method 'events' lets contacts land, lift, stick and slip by themselves"
LIMITS = "the methods 'events' and 'time_stepping' stop joints at their limits"


class Seen(NamedTuple):
    """A mechanism at some times: (k,), states and controls (names, k), forces by name."""

    t: Array
    x: Array
    u: Array
    forces: Mapping[str, Array]


class Remark(NamedTuple):
    """Something, when it was so first, and what to do about it."""

    text: str
    time: float
    mend: str


def remarks(experiment: Experiment, outcome: Outcome) -> list[str]:
    """One warning for each thing that was not heeded."""
    plant = experiment.mechanism
    if plant is None:
        return []
    found: dict[str, str] = {}
    with np.errstate(all="ignore"):
        for seen in _looks(experiment, outcome):
            told = [*_motors(experiment, plant.model, seen)]
            if isinstance(experiment.simulation.method, Smooth):
                told += [*_held(plant.model, seen), *_apart(experiment, plant.model, seen)]
            for one in told:
                found.setdefault(one.text, f"{one.text} from t = {one.time:.4g} s on; {one.mend}")
    return list(found.values())


def too_deep(experiment: Experiment, outcome: Outcome) -> tuple[SimulationStatus, str] | None:
    """Why a motion has not come to its end as it should have: it went through the ground."""
    plant = experiment.mechanism
    if plant is None or isinstance(experiment.simulation.method, Smooth):
        return None
    system = _rows(experiment, plant.model)
    with np.errstate(all="ignore"):
        for seen in _looks(experiment, outcome):
            gaps = system.rows(system.at(seen.t, seen.x)).gaps
            for name, gap in zip(system.names, gaps, strict=True):
                lost = np.flatnonzero(~np.isfinite(gap))
                if len(lost):
                    words = f"the gap of '{name}' has no finite value at t = {seen.t[lost[0]]:.6g}"
                    return SimulationStatus.INVALID_NUMBER, f"{words} s"
                if gap.min() < -DEPTH:
                    k = int(np.argmax(gap < -DEPTH))
                    words = f"'{name}' is {-gap[k]:.3g} beyond where it touches at t = "
                    return SimulationStatus.DIVERGED, (
                        f"{words}{seen.t[k]:.6g} s: the method missed that it touches; "
                        "take shorter steps"
                    )
    return None


def _rows(experiment: Experiment, model: Multibody) -> Unilateral:
    return Unilateral.of(model, experiment.drive, model.statics)


def _looks(experiment: Experiment, outcome: Outcome) -> Iterator[Seen]:
    """Every stretch at its steps and between them."""
    total = sum(len(one.times) for one in outcome.stretches)
    stride = math.ceil(2 * total / MOST_LOOKS)
    for stretch in outcome.stretches:
        ends = stretch.times
        middles = (ends[:-1] + ends[1:]) / 2
        t = np.sort(np.concatenate([ends, middles]))
        t = np.unique(np.concatenate([t[::stride], t[-1:]]))
        x, u = along(experiment, stretch, t)
        yield Seen(t, x, u, outcome.forces(stretch, t, x, u) if outcome.forces else {})


def _held(model: Multibody, seen: Seen) -> Iterator[Remark]:
    """Contacts of the mode that would not stay in it."""
    q, v = np.split(seen.x, 2)
    touch = model.at(seen.t, q, v, seen.u).contacts
    for name, doing in model.mechanism.mode.items():
        row = model.pairs.index(name)
        normal = seen.forces[f"contact.{name}.normal"]
        slight = SLIGHT * float(np.abs(normal).max())
        yield from _said(seen, normal + slight, f"the held contact '{name}' pulls", EVENTS)
        if doing == "sticking":
            cone = model.friction[row] * np.maximum(normal, 0)
            room = cone - np.abs(seen.forces[f"contact.{name}.tangential"])
            text = f"the sticking contact '{name}' leaves its friction cone"
            yield from _said(seen, room + slight, text, EVENTS)
        if doing in ("sliding_left", "sliding_right"):
            slip = touch.slips[row] * (1 if doing == "sliding_right" else -1)
            text = f"the contact '{name}' slips against its '{doing}'"
            yield from _said(seen, slip + SLIGHT, text, EVENTS)


def _apart(experiment: Experiment, model: Multibody, seen: Seen) -> Iterator[Remark]:
    """Contacts that are not in the mode, and limits of joints."""
    system = _rows(experiment, model)
    gaps = system.rows(system.at(seen.t, seen.x)).gaps
    for row, (name, gap) in enumerate(zip(system.names, gaps, strict=True)):
        if name in model.mechanism.mode:
            continue
        if row < system.pairs:
            other = model.mechanism.touching[name].against
            text = f"the contact '{name}', which is not in the mode, goes through '{other}'"
            yield from _said(seen, gap + SLIGHT, text, EVENTS)
        else:
            joint, _, side = name.rpartition(".")
            text = f"the joint '{joint}' passes its {side} limit"
            yield from _said(seen, gap + SLIGHT, text, LIMITS)


def _motors(experiment: Experiment, model: Multibody, seen: Seen) -> Iterator[Remark]:
    """Limits of motors, which the controls are to keep."""
    known = {**experiment.statics, **resolve.parameters(model.mechanism)}
    q, v = np.split(seen.x, 2)
    for name, motor in model.mechanism.motors.items():
        for word in ("torque", "speed", "power", "current"):
            lower, upper = resolve.interval(getattr(motor, word), known)
            if not (math.isfinite(lower) or math.isfinite(upper)):
                continue
            full = f"motor.{name}.{word}"
            values = model.values([full], seen.t, q, v, seen.u)[0]
            room = np.minimum(values - lower, upper - values)
            slight = SLIGHT * max(abs(one) for one in (lower, upper) if math.isfinite(one))
            text = f"'{full}' passes its limit"
            mend = "limits of motors do not act here: keep to them in 'controls'"
            yield from _said(seen, room + slight, text, mend)


def _said(seen: Seen, room: Array, text: str, mend: str) -> Iterator[Remark]:
    """A warning with the first time at which there is no room."""
    below = np.flatnonzero(room < 0)
    if not len(below):
        return
    k, time = int(below[0]), float(seen.t[below[0]])
    if k > 0:
        share = room[k - 1] / (room[k - 1] - room[k])
        time = float(seen.t[k - 1] + share * (seen.t[k] - seen.t[k - 1]))
    yield Remark(text, time, mend)
