"""The NLP's point -> trajectories: the one place where arrays turn from CasADi's order."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curves
from schemas.results import CurveGroup, Group, PhaseResult, finite
from solver.trajectory import Trajectory
from solver.transcribe.layout import PhaseLayout
from solver.transcribe.transcribe import Transcribed
from solver.transcriptions.base import Transcription

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Nodes:
    """A phase at all nodes of all segments: x, f, u (segments, nodes, names); its integrals."""

    x: Array
    f: Array
    u: Array
    integrals: Array


def extract(
    transcribed: Transcribed, transcription: Transcription, w: Array
) -> tuple[list[Trajectory], list[PhaseResult]]:
    """Read the trajectories of all phases out of the decision variables ``w`` (SI)."""
    trajectories, results = [], []
    for index, layout in enumerate(transcribed.layouts):
        start, end = _times(layout, w)
        nodes = _evaluate(transcribed, index, len(transcription.nodes), w)
        breaks = start + (end - start) * layout.mesh.knots
        trajectory = _curves(layout, transcription, nodes, breaks)
        trajectories.append(trajectory)
        results.append(_result(layout, transcription, nodes, trajectory))
    return trajectories, results


def _times(layout: PhaseLayout, w: Array) -> tuple[float, float]:
    limits = (layout.phase.start, layout.phase.end)
    start, end = (
        side.lower if at is None else float(w[at])
        for side, at in zip(limits, layout.times, strict=True)
    )
    return start, end


def _evaluate(transcribed: Transcribed, index: int, count: int, w: Array) -> _Nodes:
    layout, group = transcribed.layouts[index], transcribed.segments[index]
    segments = layout.mesh.segments
    outputs = transcribed.nodes[index].map(segments)(w[group.columns], group.data)

    def turned(matrix: Array) -> Array:
        """(names, segments * nodes) -> (segments, nodes, names)."""
        return np.moveaxis(matrix.reshape(len(matrix), segments, count), 0, 2)

    *series, integrals = (output.full() for output in outputs)
    x, f, u = (turned(matrix) for matrix in series)
    return _Nodes(x, f, u, integrals.sum(axis=1))


def _curves(
    layout: PhaseLayout, transcription: Transcription, nodes: _Nodes, breaks: Array
) -> Trajectory:
    states = transcription.state_curve(nodes.x, nodes.f, np.diff(breaks)[:, None])
    parts = np.full(layout.mesh.segments, transcription.pieces)
    fractions = layout.mesh.subdivide(parts).knots
    breaks = breaks[0] + (breaks[-1] - breaks[0]) * fractions
    controls = transcription.control_curve(nodes.u)
    return Trajectory(
        float(breaks[0]),
        float(breaks[-1]),
        Curves(breaks, dict(zip(layout.phase.states, states, strict=True))),
        Curves(breaks, dict(zip(layout.phase.controls, controls, strict=True))),
    )


def _result(
    layout: PhaseLayout, transcription: Transcription, nodes: _Nodes, trajectory: Trajectory
) -> PhaseResult:
    phase, duration = layout.phase, trajectory.end - trajectory.start
    times = trajectory.start + duration * layout.mesh.fractions(transcription.fractions)
    return PhaseResult(
        name=phase.name,
        knots=(trajectory.start + duration * layout.mesh.knots).tolist(),
        groups={
            "states": _group(phase.states, times, nodes.x),
            "controls": _group(phase.controls, times, nodes.u),
        },
        curves={
            "states": CurveGroup.model_validate(trajectory.states.to_dict()),
            "controls": CurveGroup.model_validate(trajectory.controls.to_dict()),
        },
        integrals={
            name: finite(value)
            for name, value in zip(phase.integrals, nodes.integrals, strict=True)
        },
    )


def _group(names: Sequence[str], times: Array, values: Array) -> Group:
    """Node values with the knots that neighbours share listed once."""
    time = np.append(times[:, :-1], times[-1, -1])
    inner = values[:, :-1].reshape(len(time) - 1, len(names))
    series = np.concatenate([inner, values[-1:, -1]])
    columns = {name: [finite(v) for v in series[:, i]] for i, name in enumerate(names)}
    return Group(time=time.tolist(), values=columns)
