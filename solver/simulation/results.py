"""From a motion to what is published: series, curves, energies."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from footfall.curves import Curves
from schemas.limits import MODEL_LIMITS
from schemas.results import CurveGroup, Group, PhaseResult, finite
from schemas.simulated import Energy, ModeSequence, SimulationStatus
from solver.numeric.tape import Array
from solver.simulation.exchange import changing
from solver.simulation.experiment import Experiment, Outcome, Stretch
from solver.simulation.frames import with_frames
from solver.simulation.multibody import Multibody
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_instant import SpatialInstant

MAX_PIECES = MODEL_LIMITS.segments
"""Of the published curves; where there are more steps, each piece holds some of them."""

HURRIED = 500
"""The same of a motion that was cancelled: it has a second to be told, then it is stopped."""


@dataclass(frozen=True, slots=True)
class Table:
    """Series (names, k) over times (k,), which repeat where something jumps."""

    t: Array
    x: Array
    u: Array
    forces: Mapping[str, Array]


def phase_result(experiment: Experiment, outcome: Outcome, samples: int) -> PhaseResult:
    """The motion as the one phase of a result."""
    table = tabulate(experiment, outcome, samples)
    groups = {
        "states": _group(table.t, dict(zip(experiment.plant.states, table.x, strict=True))),
        "controls": _group(table.t, dict(zip(experiment.plant.controls, table.u, strict=True))),
    }
    if table.forces:
        groups["forces"] = _group(table.t, table.forces)
    bare = PhaseResult(
        name="simulation",
        knots=_knots(outcome),
        groups=groups,
        curves=_curves(experiment, outcome),
    )
    return with_frames(bare, experiment.simulation.system, experiment.statics)


def energy_of(experiment: Experiment, outcome: Outcome) -> Energy | None:
    """How the energy of a mechanism goes, looked at after every step."""
    model = experiment.model
    if model is None:
        return None
    names = ["energy.kinetic", "energy.potential"]
    rows, driven = [np.zeros((2, 0))], False
    for stretch in outcome.stretches:
        t = stretch.times
        x, u = along(experiment, stretch, t)
        n, driven = len(x) // 2, driven or bool(np.any(u))
        rows.append(model.values(names, t, x[:n], x[n:], u))
    kinetic, potential = np.concatenate(rows, axis=1)
    if not len(kinetic):
        return None
    total = kinetic + potential
    change = float(np.abs(total - total[0]).max())
    size = max(float(kinetic.max()), float(np.ptp(potential)), _least(model))
    kept = not (driven or changing(experiment, outcome))
    return Energy(
        initial=finite(total[0]),
        final=finite(total[-1]),
        drift=finite(change / size) if kept else None,
    )


def _least(model: Multibody | SpatialMultibody) -> float:
    """The energy below which drifts are round-off: that of all its mass at 1 mm/s, J."""
    at = model.at(0.0, np.ones((len(model.coordinates), 1)))
    mass = at.mass_total if isinstance(at, SpatialInstant) else at.parts.masses.sum()
    return 1e-6 * float(mass) or 1e-12


def sequence_of(experiment: Experiment, outcome: Outcome) -> ModeSequence | None:
    """The modes in order, where a method told any."""
    plant = experiment.mechanism
    if plant is None or not outcome.modes:
        return None
    pairs = list(plant.model.pairs)
    distinct = {tuple(sorted(span.contacts.items())) for span in outcome.modes}
    return ModeSequence(
        contacts=pairs,
        modes=list(outcome.modes),
        distinct=len(distinct),
        possible=4 ** len(pairs),
    )


def tabulate(experiment: Experiment, outcome: Outcome, samples: int) -> Table:
    """Series at equal times, and on both sides of every jump."""
    parts = []
    if not outcome.stretches:
        t, x = np.array([experiment.start]), experiment.state[:, None]
        return Table(t, x, experiment.drive(t, x, experiment.start), {})
    first, last = outcome.stretches[0].times[0], outcome.stretches[-1].times[-1]
    grid = np.linspace(first, last, samples)
    for stretch in outcome.stretches:
        start, end = stretch.times[[0, -1]]
        inside = grid[(grid > start) & (grid < end)]
        times = np.concatenate([[start], inside, [end]]) if end > start else np.array([start])
        parts.append(_sampled(experiment, outcome, stretch, times))
    names = dict.fromkeys(name for part in parts for name in part.forces)
    return Table(
        np.concatenate([part.t for part in parts]),
        np.concatenate([part.x for part in parts], axis=1),
        np.concatenate([part.u for part in parts], axis=1),
        {
            name: np.concatenate([part.forces.get(name, np.zeros(len(part.t))) for part in parts])
            for name in names
        },
    )


def _sampled(experiment: Experiment, outcome: Outcome, stretch: Stretch, times: Array) -> Table:
    x, u = along(experiment, stretch, times)
    forces = outcome.forces(stretch, times, x, u) if outcome.forces else {}
    return Table(times, x, u, forces)


def along(experiment: Experiment, stretch: Stretch, times: Array) -> tuple[Array, Array]:
    """States and controls (names, k) at times (k,) of a stretch."""
    steps = np.searchsorted(stretch.times, times, side="right") - 1
    steps = np.clip(steps, 0, max(len(stretch.times) - 2, 0))
    x = np.empty((len(experiment.state), len(times)))
    u = np.empty((len(experiment.plant.controls), len(times)))
    for step in np.unique(steps):
        some = steps == step
        middle = float(stretch.times[step : step + 2].mean())
        x[:, some] = stretch.states(int(step), times[some])
        u[:, some] = experiment.drive(times[some], x[:, some], middle)
    return x, u


def _knots(outcome: Outcome) -> list[float]:
    ends = [float(one) for stretch in outcome.stretches for one in stretch.times[[0, -1]]]
    return sorted(set(ends))


def thinning(outcome: Outcome) -> int:
    """How many steps one piece of the published curves holds: one, unless there are very many."""
    steps = sum(len(stretch.times) - 1 for stretch in outcome.stretches)
    most = HURRIED if outcome.status is SimulationStatus.CANCELLED else MAX_PIECES
    return max(1, math.ceil(steps / most))


def _curves(experiment: Experiment, outcome: Outcome) -> dict[str, CurveGroup]:
    """One polynomial a step: exact for the states, through as many points for the controls."""
    nodes, stride = chebyshev.chebpts1(outcome.degree + 1), thinning(outcome)
    breaks, xs, us = [], [], []
    for stretch in outcome.stretches:
        edges = [*stretch.times[:-1:stride].tolist(), float(stretch.times[-1])]
        for a, b in pairwise(edges):
            t = a + (b - a) * (nodes + 1) / 2
            x, u = along(experiment, stretch, t)
            xs.append(x.T)
            us.append(u.T)
            breaks.append(a)
    if not breaks:
        return {}
    breaks.append(float(outcome.stretches[-1].times[-1]))
    plant = experiment.plant
    return {
        "states": _curve_group(plant.states, breaks, nodes, xs),
        "controls": _curve_group(plant.controls, breaks, nodes, us),
    }


def _curve_group(
    names: Sequence[str], breaks: Sequence[float], nodes: Array, values: Sequence[Array]
) -> CurveGroup:
    curves = Curves.through(list(names), breaks, nodes, np.array(values))
    return CurveGroup.model_validate(curves.to_dict())


def _group(t: Array, rows: Mapping[str, Array]) -> Group:
    values = {name: [finite(one) for one in row.tolist()] for name, row in rows.items()}
    return Group(time=t.tolist(), values=values)
