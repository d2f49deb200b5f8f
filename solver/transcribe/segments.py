"""The stage groups of one phase: its segments, and the path constraints at its knots."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.lowering import Form
from solver.model import Constraint, Interval
from solver.model.drift import drift_names, held_labels
from solver.model.symbolic import PhaseFunctions, Place, path_rows
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Indices
from solver.transcribe.layout import KINDS, PhaseLayout, Shared, Strip
from solver.transcriptions.base import Collocation, Point, Segment


@dataclass(frozen=True, slots=True)
class SymbolicStage:
    """A segment in symbols, completed by the transcription; ``own`` are its variables."""

    own: SX
    h: SX
    collocation: Collocation
    functions: PhaseFunctions
    statics: SX

    def place(self, point: Point) -> Place:
        """A point of the segment as the functions take it."""
        return Place(point.x, point.u, point.z, point.natives, point.t, self.statics)

    def at(self, function: ca.Function, point: Point) -> SX:
        """A function's value at a point of the segment."""
        return SX(function(*self.place(point).arguments()))

    def quadrature(self) -> SX:
        """The integrals over the segment, by the transcription's own rule."""
        terms = [
            weight * self.at(self.functions.integrands, point)
            for weight, point in self.collocation.quadrature
        ]
        return self.h * sum(terms[1:], start=terms[0])


def symbolic_stage(
    strip: Strip, shared: Shared, place: SX, functions: PhaseFunctions
) -> SymbolicStage:
    """A segment's symbols, completed by the transcription.

    ``place`` (2,) is where it starts in the phase and its width, as fractions of the duration.
    """
    fraction, width = ca.vertsplit(place)
    times, blocks = shared.times, strip.blocks
    own = [
        [SX.sym(kind, len(blocks[kind][i])) for kind in KINDS]
        for i in range(len(strip.transcription.nodes))
    ]
    still = SX.zeros(len(blocks["drift"][-1]), 1)  # nothing drifts at a segment's start
    points = tuple(
        Point(
            x,
            u,
            ca.vertcat(z, drift if i else still),
            times.at(fraction + node.fraction * width),
            natives,
        )
        for i, (node, (x, u, z, natives, drift)) in enumerate(
            zip(strip.transcription.nodes, own, strict=True)
        )
    )
    h = (times.end - times.start) * width

    def derivative(point: Point) -> SX:
        return SX(functions.derivatives(*_arguments(point, shared.statics)))

    def flow(natives: SX, t: SX) -> SX:
        return SX(functions.flow(natives, t, shared.statics))

    collocation = strip.transcription.collocate(Segment(points, h, derivative, flow))
    stacked = ca.vertcat(*(part for parts in own for part in parts))
    return SymbolicStage(stacked, h, collocation, functions, shared.statics)


def _arguments(point: Point, statics: SX) -> list[SX]:
    return Place(point.x, point.u, point.z, point.natives, point.t, statics).arguments()


def segment_group(
    index: int, layout: PhaseLayout, strip: Strip, functions: PhaseFunctions, weights: Array
) -> tuple[StageGroup, ca.Function]:
    """Defects, quadrature, and constraints at nodes inside of the segments.

    ``weights`` (sums, integrals) says what each integral adds to each sum of the program. With
    the group comes the function that reads its segments out: variables, constants -> x, f, u, z
    (names, nodes), and the integrals; z is zero at nodes without algebraic variables.
    """
    place, shared = SX.sym("place", 2), layout.shared()
    stage = symbolic_stage(strip, shared, place, functions)
    integrals = stage.quadrature()
    sums = ca.mtimes(ca.DM(weights), integrals) if weights.size else SX(len(weights), 1)
    group = StageGroup(
        phase=index,
        variables=ca.vertcat(stage.own, shared.symbols),
        constants=place,
        columns=_with_shared(strip.columns(), shared),
        data=strip.places,
        rows=_segment_rows(layout, strip, stage),
        sums=sums,
    )
    points = stage.collocation.points
    outputs = [
        ca.horzcat(*(point.x for point in points)),
        ca.horzcat(*(stage.at(functions.derivatives, point) for point in points)),
        ca.horzcat(*(point.u for point in points)),
        ca.horzcat(*(point.z for point in points)),
        integrals,
    ]
    return group, ca.Function("nodes", [group.variables, place], outputs)


def knot_group(
    index: int, layout: PhaseLayout, functions: PhaseFunctions, sums: int
) -> list[StageGroup]:
    """Path constraints at shared knots; nothing where there are none of either."""
    transcription = layout.transcription
    path = path_rows(layout.phase, eliminate=transcription.eliminates)
    which = [i for i in range(len(path)) if i not in functions.native_rows]
    if not which or not transcription.shares_controls:
        return []
    shared, fraction = layout.shared(), SX.sym("fraction")
    x, u, z, *_ = (SX.sym(kind, len(layout.knots[kind])) for kind in KINDS)
    natives = SX.zeros(len(layout.phase.natives), 1)  # no row of these uses them
    whole = ca.vertcat(z, SX.zeros(len(drift_names(layout.phase.form)), 1))  # nor those
    place = Place(x, u, whole, natives, shared.times.at(fraction), shared.statics)
    knots = layout.mesh.knots[None, :]
    rows = _path_rows(path, which, SX(functions.path(*place.arguments())), knots)
    columns = _with_shared(layout.knot_columns(), shared)
    variables = ca.vertcat(x, u, z, shared.symbols)
    return [StageGroup(index, variables, fraction, columns, knots, rows, SX(sums, 1))]


def _with_shared(columns: Indices, shared: Shared) -> Indices:
    return np.concatenate([columns, np.repeat(shared.columns[:, None], columns.shape[1], axis=1)])


def _segment_rows(layout: PhaseLayout, strip: Strip, stage: SymbolicStage) -> Rows:
    transcription, collocation = strip.transcription, stage.collocation
    parts = [_defect_rows(layout, strip, collocation)]
    path = path_rows(layout.phase, eliminate=transcription.eliminates)
    plain = [i for i in range(len(path)) if i not in stage.functions.native_rows]
    last = len(transcription.nodes) - 1
    for index, (node, point) in enumerate(
        zip(transcription.nodes, collocation.points, strict=True)
    ):
        where = strip.fractions(np.array([node.fraction])).T
        values = stage.at(stage.functions.path, point)
        parts.append(_path_rows(path, sorted(stage.functions.native_rows), values, where))
        at_knot = index in (0, last)
        if at_knot and (transcription.shares_controls or not node.control):
            continue
        parts.append(_path_rows(path, plain, values, where))
        if not node.state:
            parts.append(_bound_rows(layout, layout.phase.states, point.x, where))
    middle = strip.fractions(np.array([0.5])).T
    parts += [
        _bound_rows(layout, layout.phase.controls, corner, middle, of_nodes=True)
        for corner in collocation.hull
    ]
    if len(strip.blocks["drift"][-1]):
        parts += _held_rows(layout.phase.form, strip, stage)
    return _stacked([part for part in parts if part.names] or parts[:1])


def _held_rows(form: Form, strip: Strip, stage: SymbolicStage) -> list[Rows]:
    """What contacts and loops hold, at every node but the first.

    Places that are not anchored are those at the segment's start: from knot to knot these agree.
    """
    held, points = form.holonomic, stage.collocation.points
    places = [one for one in held if one.place is not None]
    moving = SX([0.0 if one.anchored else 1.0 for one in places] + [0.0] * len(held))
    start = stage.at(stage.functions.held, points[0]) * moving
    labels, zero = held_labels(held), Interval(0.0, 0.0)
    return [
        _rows(
            labels,
            ca.vertsplit(stage.at(stage.functions.held, point) - start),
            [zero] * len(labels),
            strip.fractions(np.array([node.fraction])).T,
        )
        for node, point in zip(strip.transcription.nodes[1:], points[1:], strict=True)
    ]


def _defect_rows(layout: PhaseLayout, strip: Strip, collocation: Collocation) -> Rows:
    count = collocation.defects.numel()
    repeats = count // len(layout.phase.states)
    middles = strip.fractions(np.array([0.5])).T
    return Rows(
        collocation.defects,
        tuple(f"defect {name}" for name in layout.phase.states) * repeats,
        np.zeros(count),
        np.zeros(count),
        np.tile(layout.state_scale, repeats),
        np.repeat(middles, count, axis=0),
    )


def _bound_rows(
    layout: PhaseLayout, names: Sequence[str], values: SX, where: Array, *, of_nodes: bool = False
) -> Rows:
    """Bounds on what is no variable here, as rows.

    What is made ``of_nodes`` alone is fixed where these are, and needs no row then.
    """
    bounds = layout.phase.bounds
    bounded = [
        i
        for i, name in enumerate(names)
        if bounds[name].finite and not (of_nodes and bounds[name].fixed)
    ]
    return _rows(
        [f"bound {names[i]}" for i in bounded],
        [values[i] for i in bounded],
        [bounds[names[i]] for i in bounded],
        where,
    )


def _path_rows(path: Sequence[Constraint], which: Iterable[int], values: SX, where: Array) -> Rows:
    rows = [(path[i], values[i]) for i in which]
    return _rows(
        [row.label for row, _ in rows],
        [value for _, value in rows],
        [row.limits for row, _ in rows],
        where,
    )


def _rows(
    names: Sequence[str], values: Sequence[SX], limits: Sequence[Interval], where: Array
) -> Rows:
    """Rows at one node of each segment, which lies at ``where`` (1, segments)."""
    return Rows(
        ca.vertcat(SX(0, 1), *values),
        tuple(names),
        np.array([side.lower for side in limits]),
        np.array([side.upper for side in limits]),
        np.array([limit_magnitude(side) for side in limits]),
        np.repeat(where, len(names), axis=0),
    )


def limit_magnitude(limits: Interval) -> float:
    """The size by which a constraint's row is divided: its largest finite limit, at least 1."""
    return max(1.0, *(abs(side) for side in limits if np.isfinite(side)))


def _stacked(parts: Sequence[Rows]) -> Rows:
    return Rows(
        ca.vertcat(*(part.expression for part in parts)),
        tuple(name for part in parts for name in part.names),
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("lower", "upper", "magnitude", "fractions")
        ),
    )
