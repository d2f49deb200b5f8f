"""Costates of the continuous problem from the multipliers of the defects."""

from collections.abc import Sequence

import numpy as np

from schemas.results import Group, PhaseResult, finite
from solver.nlp.stages import StageGroup
from solver.nlp.variables import Array
from solver.transcribe.layout import PhaseLayout, Strip
from solver.transcribe.transcribe import Transcribed

_SAME = 1e-12  # of the phase: nodes that neighbours share


def with_costates(
    transcribed: Transcribed, multipliers: Array, phases: Sequence[PhaseResult]
) -> list[PhaseResult]:
    """The results with a group ``costates`` at the times at which each method knows them.

    One series per state of the user's: the objective's change per unit of the state.

    Parameters
    ----------
    multipliers
        Of all rows (m,) in SI units, positive where a row's upper limit pushes: at an optimum
        the objective's gradient plus the rows' gradients times these is zero.
    """
    results = []
    for index, phase in enumerate(phases):
        group = _group(transcribed, multipliers, index, phase.knots[0], phase.knots[-1])
        groups = phase.groups if group is None else {**phase.groups, "costates": group}
        results.append(phase.model_copy(update={"groups": groups}))
    return results


def _group(
    transcribed: Transcribed, multipliers: Array, phase: int, start: float, end: float
) -> Group | None:
    layout = transcribed.layouts[phase]
    if layout.transcription.native:
        return _of_accelerations(transcribed, multipliers, phase, start, end)
    parts = [
        _of_strip(layout, strip, _rows_of(transcribed, group, multipliers))
        for strip, group in zip(layout.strips, transcribed.segments[phase], strict=True)
    ]
    known = [part for part in parts if part is not None]
    if not known:
        return None
    fractions = np.concatenate([places for places, _ in known])
    values = np.concatenate([rows for _, rows in known])
    order = np.argsort(fractions, kind="stable")
    time = start + (end - start) * fractions[order]
    own = layout.phase.chain.publish["states"]
    series = {
        name: [finite(value) for value in values[order, i]]
        for i, name in enumerate(layout.phase.states)
        if name in own
    }
    return Group(time=time.tolist(), values=series)


def _of_accelerations(
    transcribed: Transcribed, multipliers: Array, phase: int, start: float, end: float
) -> Group | None:
    """The costates of the velocities, from the rows of the dynamics of a native form.

    A row says dd(q) - acceleration = 0 at a point; its multiplier is the costate of d(q) there
    times the point's weight in the quadrature. At a knot the weights of both neighbours add.
    Nothing where accelerations are given by residuals: there the rows are not in their units.
    """
    layout = transcribed.layouts[phase]
    if layout.phase.chain.unknowns:
        return None
    places, weights = _points(layout)
    labels = list(layout.phase.form.residuals)
    found = np.full((len(places), len(labels)), np.nan)
    for group in transcribed.program.groups:
        if group.phase != phase:
            continue
        own = _rows_of(transcribed, group, multipliers)
        for row, name in enumerate(group.rows.names):
            if name in labels:
                at = np.searchsorted(places, group.rows.fractions[row] - _SAME)
                found[at, labels.index(name)] = own[:, row]
    values = -found / ((end - start) * weights[:, None])
    count = len(labels)
    names = layout.phase.states[count : 2 * count]
    series = {name: [finite(value) for value in values[:, i]] for i, name in enumerate(names)}
    return Group(time=(start + (end - start) * places).tolist(), values=series)


def _points(layout: PhaseLayout) -> tuple[Array, Array]:
    """The nodes of a phase as fractions of it, once each, and their weights for length one."""
    nodes, weights = list[Array](), list[Array]()
    for strip in layout.strips:
        own = strip.transcription
        nodes.append(strip.fractions(own.fractions).ravel())
        weights.append((strip.places[1][:, None] * np.array(own.weights)).ravel())
    places, shares = np.concatenate(nodes), np.concatenate(weights)
    order = np.argsort(places, kind="stable")
    first = np.append(True, np.diff(places[order]) > _SAME)
    return places[order][first], np.add.reduceat(shares[order], np.flatnonzero(first))


def _rows_of(transcribed: Transcribed, group: StageGroup, multipliers: Array) -> Array:
    """The multipliers of a group's own rows, (stages, rows)."""
    groups: Sequence[StageGroup] = transcribed.program.groups
    before = groups[: next(i for i, other in enumerate(groups) if other is group)]
    start = sum(len(other.rows.names) * other.stages for other in before)
    count = len(group.rows.names)
    return multipliers[start : start + count * group.stages].reshape(group.stages, count)


def _of_strip(layout: PhaseLayout, strip: Strip, multipliers: Array) -> tuple[Array, Array] | None:
    """Fractions (n,) of the phase, and costates there (n, states)."""
    found = strip.transcription.costates(multipliers, len(layout.phase.states))
    if found is None:
        return None
    places, values = found
    return strip.fractions(places).ravel(), values.reshape(-1, values.shape[2])
