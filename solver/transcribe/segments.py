"""The stage groups of one phase: its segments, and the path constraints at its knots."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.model import Constraint, Interval
from solver.model.symbolic import PhaseFunctions
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Indices
from solver.transcribe.layout import PhaseLayout, TimeSymbols
from solver.transcriptions.base import Collocation, Point, Segment, Transcription


@dataclass(frozen=True, slots=True)
class SymbolicStage:
    """A segment in symbols, completed by the transcription; ``own`` are its variables."""

    own: SX
    h: SX
    collocation: Collocation


def segment_group(
    index: int,
    layout: PhaseLayout,
    transcription: Transcription,
    functions: PhaseFunctions,
    weights: Array,
) -> StageGroup:
    """Defects, quadrature, and constraints at nodes inside of the segments.

    ``weights`` (sums, integrals) says what each integral adds to each sum of the program.
    """
    place, times = SX.sym("place", 2), layout.time_symbols()
    stage = symbolic_stage(layout, times, place, transcription, functions)
    quadrature = _quadrature(stage, functions)
    return StageGroup(
        phase=index,
        variables=ca.vertcat(stage.own, times.free),
        constants=place,
        columns=_with_times(layout.segment_columns(), layout),
        data=np.stack([layout.mesh.knots[:-1], np.diff(layout.mesh.knots)]),
        rows=_segment_rows(layout, transcription, functions, stage.collocation),
        sums=ca.mtimes(ca.DM(weights), quadrature) if weights.size else SX(weights.shape[0], 1),
    )


def segment_nodes(
    layout: PhaseLayout, transcription: Transcription, functions: PhaseFunctions
) -> ca.Function:
    """Segment's variables, constants -> x, f, u (names, nodes), and its integrals (integrals,)."""
    place, times = SX.sym("place", 2), layout.time_symbols()
    stage = symbolic_stage(layout, times, place, transcription, functions)
    points = stage.collocation.points
    outputs = [
        ca.horzcat(*(point.x for point in points)),
        ca.horzcat(*(functions.derivatives(point.x, point.u, point.t) for point in points)),
        ca.horzcat(*(point.u for point in points)),
        _quadrature(stage, functions),
    ]
    return ca.Function("nodes", [ca.vertcat(stage.own, times.free), place], outputs)


def _quadrature(stage: SymbolicStage, functions: PhaseFunctions) -> SX:
    """The integrals over one segment, by the transcription's own rule."""
    return stage.h * sum(
        weight * functions.integrands(point.x, point.u, point.t)
        for weight, point in stage.collocation.quadrature
    )


def knot_group(
    index: int,
    layout: PhaseLayout,
    transcription: Transcription,
    functions: PhaseFunctions,
    sums: int,
) -> list[StageGroup]:
    """Path constraints at shared knots; nothing where there are none of either."""
    path = layout.phase.path
    if not path or not transcription.shares_controls:
        return []
    times, fraction = layout.time_symbols(), SX.sym("fraction")
    x = SX.sym("x", len(layout.phase.states))
    u = SX.sym("u", len(layout.phase.controls))
    knots = layout.mesh.knots[None, :]
    rows = _path_rows(path, functions.path(x, u, times.at(fraction)), knots)
    columns = _with_times(layout.knot_columns(), layout)
    variables = ca.vertcat(x, u, times.free)
    return [StageGroup(index, variables, fraction, columns, knots, rows, SX(sums, 1))]


def _with_times(columns: Indices, layout: PhaseLayout) -> Indices:
    times = np.array(layout.free_times(), dtype=int)[:, None]
    return np.concatenate([columns, np.repeat(times, columns.shape[1], axis=1)])


def symbolic_stage(
    layout: PhaseLayout,
    times: TimeSymbols,
    place: SX,
    transcription: Transcription,
    functions: PhaseFunctions,
) -> SymbolicStage:
    """A segment's symbols, completed by the transcription.

    ``place`` (2,) is where it starts in the phase and its width, as fractions of the duration.
    """
    fraction, width = ca.vertsplit(place)
    points = tuple(
        Point(
            SX.sym("x", states.shape[0]),
            SX.sym("u", controls.shape[0]),
            times.at(fraction + node.fraction * width),
        )
        for node, states, controls in zip(
            transcription.nodes, layout.states, layout.controls, strict=True
        )
    )
    h = (times.end - times.start) * width
    collocation = transcription.collocate(
        Segment(points, h, lambda point: functions.derivatives(point.x, point.u, point.t))
    )
    own = ca.vertcat(*(part for point in points for part in (point.x, point.u)))
    return SymbolicStage(own, h, collocation)


def _segment_rows(
    layout: PhaseLayout,
    transcription: Transcription,
    functions: PhaseFunctions,
    collocation: Collocation,
) -> Rows:
    phase = layout.phase
    repeats = collocation.defects.numel() // len(phase.states)
    middles = layout.mesh.fractions(np.array([0.5])).T
    parts = [
        Rows(
            collocation.defects,
            tuple(f"defect {name}" for name in phase.states) * repeats,
            np.zeros(collocation.defects.numel()),
            np.zeros(collocation.defects.numel()),
            np.tile(layout.state_scale, repeats),
            np.repeat(middles, collocation.defects.numel(), axis=0),
        )
    ]
    last = len(transcription.nodes) - 1
    for index, (node, point) in enumerate(
        zip(transcription.nodes, collocation.points, strict=True)
    ):
        at_knot = index in (0, last)
        if at_knot and (transcription.shares_controls or not node.control):
            continue
        where = layout.mesh.fractions(np.array([node.fraction])).T
        if phase.path:
            parts.append(_path_rows(phase.path, functions.path(point.x, point.u, point.t), where))
        if not node.state:
            parts.extend(_bound_rows(layout, point, where))
    return _stacked(parts)


def _bound_rows(layout: PhaseLayout, point: Point, where: Array) -> list[Rows]:
    """Bounds on states that are no variables, as rows."""
    phase = layout.phase
    bounded = [i for i, name in enumerate(phase.states) if np.any(np.isfinite(phase.bounds[name]))]
    if not bounded:
        return []
    lower, upper = np.array([phase.bounds[phase.states[i]] for i in bounded]).T
    return [
        Rows(
            ca.vertcat(*(point.x[i] for i in bounded)),
            tuple(f"bound {phase.states[i]}" for i in bounded),
            lower,
            upper,
            layout.state_scale[bounded],
            np.repeat(where, len(bounded), axis=0),
        )
    ]


def _path_rows(path: tuple[Constraint, ...], values: SX, where: Array) -> Rows:
    limits = [row.limits for row in path]
    return Rows(
        values,
        tuple(f"path {row.name}" for row in path),
        np.array([side.lower for side in limits]),
        np.array([side.upper for side in limits]),
        np.array([limit_magnitude(side) for side in limits]),
        np.repeat(where, len(path), axis=0),
    )


def limit_magnitude(limits: Interval) -> float:
    """The size by which a constraint's row is divided: its largest finite limit, at least 1."""
    return max(1.0, *(abs(side) for side in limits if np.isfinite(side)))


def _stacked(parts: list[Rows]) -> Rows:
    return Rows(
        ca.vertcat(*(part.expression for part in parts)),
        tuple(name for part in parts for name in part.names),
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("lower", "upper", "magnitude", "fractions")
        ),
    )
