"""Costates of the continuous problem from the multipliers of the defects."""

from collections.abc import Sequence

import numpy as np

from schemas.results import Group, PhaseResult, finite
from solver.nlp.stages import StageGroup
from solver.nlp.variables import Array
from solver.transcribe.layout import PhaseLayout, Strip
from solver.transcribe.transcribe import Transcribed


def with_costates(
    transcribed: Transcribed, multipliers: Array, phases: Sequence[PhaseResult]
) -> list[PhaseResult]:
    """The results with a group ``costates`` at the times at which each method knows them.

    One series per state: the objective's change per unit of the state.

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
    series = {
        name: [finite(value) for value in values[order, i]]
        for i, name in enumerate(layout.phase.states)
    }
    return Group(time=time.tolist(), values=series)


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
