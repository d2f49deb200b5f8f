"""The stage groups of one phase: its segments, and the path constraints at its knots."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.lowering import Form
from solver.model import Constraint, Interval
from solver.model.drift import drift_names, held_labels
from solver.model.shape import PhaseShape
from solver.model.symbolic import PhaseFunctions, Place, path_rows
from solver.nlp.kept import Kept
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Indices
from solver.transcribe.layout import PhaseLayout, Shared, Strip
from solver.transcribe.stage import KINDS, Stage, TimeKind, functions_of, shared_symbols
from solver.transcriptions.base import Collocation


def segment_group(
    index: int, layout: PhaseLayout, strip: Strip, weights: Array
) -> tuple[StageGroup, ca.Function]:
    """Defects, quadrature, and constraints at nodes inside of the segments.

    ``weights`` (sums, integrals) says what each integral adds to each sum of the program. With
    the group comes the function that reads its segments out (``Stage.nodes``).
    """
    stage, shared = layout.stage(strip), layout.shared()
    symbols, sums, numbers = stage.sums(weights)
    group = StageGroup(
        phase=index,
        variables=stage.variables,
        constants=ca.vertcat(stage.constants, symbols),
        columns=_with_shared(strip.columns(), shared),
        data=_with_constants(strip.places, [*shared.values, *numbers]),
        rows=_segment_rows(layout, strip, stage),
        sums=sums,
    )
    return group, stage.nodes(symbols)


def _with_constants(data: Array, values: Sequence[float]) -> Array:
    """Numbers that are the same at all stages, below those of each."""
    same = np.array(values, dtype=float)[:, None]
    return np.concatenate([data, np.repeat(same, data.shape[1], axis=1)])


@dataclass(frozen=True, slots=True)
class _Knot:
    """A shared knot in symbols, and the values of the constraints there."""

    variables: SX
    constants: SX
    path: SX


def knot_group(index: int, layout: PhaseLayout, sums: int) -> list[StageGroup]:
    """Path constraints at shared knots; nothing where there are none of either."""
    eliminate = layout.transcription.eliminates
    path = path_rows(layout.phase, eliminate=eliminate)
    if not path or not layout.transcription.shares_controls:
        return []
    functions = functions_of(layout.shape, eliminate=eliminate)
    which = [i for i in range(len(path)) if i not in functions.native_rows]
    if not which:
        return []
    shared, sizes = layout.shared(), tuple(len(layout.knots[kind]) for kind in KINDS)
    key = (layout.shape, eliminate, sizes, shared.times)
    knot = _KNOTS.get(key, lambda: _knot(layout.shape, functions, sizes, shared.times))
    knots = layout.mesh.knots[None, :]
    rows = _path_rows(path, which, knot.path, knots)
    columns = _with_shared(layout.knot_columns(), shared)
    data = _with_constants(knots, shared.values.tolist())
    none = SX(sums, 1)
    return [StageGroup(index, knot.variables, knot.constants, columns, data, rows, none)]


def _knot(
    shape: PhaseShape,
    functions: PhaseFunctions,
    sizes: Sequence[int],
    times: tuple[TimeKind, TimeKind],
) -> _Knot:
    shared, fraction = shared_symbols(shape, times), SX.sym("fraction")
    x, u, z, *_ = (SX.sym(kind, size) for kind, size in zip(KINDS, sizes, strict=True))
    natives = SX.zeros(len(shape.natives), 1)  # no row of these uses them
    whole = ca.vertcat(z, SX.zeros(len(drift_names(shape)), 1))  # nor those
    place = Place(x, u, whole, natives, shared.times.at(fraction), shared.p)
    return _Knot(
        ca.vertcat(x, u, z, shared.symbols),
        ca.vertcat(fraction, shared.constants),
        SX(functions.path(*place.arguments())),
    )


_KNOTS: Kept[_Knot] = Kept(100_000, lambda knot: int(ca.n_nodes(knot.path)))


def _with_shared(columns: Indices, shared: Shared) -> Indices:
    return np.concatenate([columns, np.repeat(shared.columns[:, None], columns.shape[1], axis=1)])


def _segment_rows(layout: PhaseLayout, strip: Strip, stage: Stage) -> Rows:
    transcription, collocation = strip.transcription, stage.collocation
    parts = [_defect_rows(layout, strip, collocation)]
    path = path_rows(layout.phase, eliminate=transcription.eliminates)
    native = stage.functions.native_rows
    plain = [i for i in range(len(path)) if i not in native]
    last = len(transcription.nodes) - 1
    for index, (node, point) in enumerate(
        zip(transcription.nodes, collocation.points, strict=True)
    ):
        where = strip.fractions(np.array([node.fraction])).T
        at_knot = index in (0, last)
        once = at_knot and (transcription.shares_controls or not node.control)
        which = [*sorted(native), *([] if once else plain)]
        if which:
            parts.append(_path_rows(path, which, stage.path(index), where))
        if not once and not node.state:
            parts.append(_bound_rows(layout, layout.phase.states, point.x, where))
    middle = strip.fractions(np.array([0.5])).T
    parts += [
        _bound_rows(layout, layout.phase.controls, corner, middle, of_nodes=True)
        for corner in collocation.hull
    ]
    parts.append(
        _rows(
            [row.label for row in collocation.rows],
            [row.value for row in collocation.rows],
            [Interval(row.lower, row.upper) for row in collocation.rows],
            middle,
        )
    )
    if len(strip.blocks["drift"][-1]):
        parts += _held_rows(layout.phase.form, strip, stage)
    return _stacked([part for part in parts if part.names] or parts[:1])


def _held_rows(form: Form, strip: Strip, stage: Stage) -> list[Rows]:
    """What contacts and loops hold, at every node but the first.

    Places that are not anchored are those at the segment's start: from knot to knot these agree.
    """
    held = form.holonomic
    places = [one for one in held if one.place is not None]
    moving = (*(not one.anchored for one in places), *(False for _ in held))
    labels, zero = held_labels(held), Interval(0.0, 0.0)
    return [
        _rows(
            labels,
            ca.vertsplit(stage.held(number, moving)),
            [zero] * len(labels),
            strip.fractions(np.array([node.fraction])).T,
        )
        for number, node in enumerate(strip.transcription.nodes[1:], start=1)
    ]


def _defect_rows(layout: PhaseLayout, strip: Strip, collocation: Collocation) -> Rows:
    count = collocation.defects.numel()
    names = layout.phase.states[:count]  # of time steps, some states have none
    repeats = count // len(names) if names else 0
    middles = strip.fractions(np.array([0.5])).T
    return Rows(
        collocation.defects,
        tuple(f"defect {name}" for name in names) * repeats,
        np.zeros(count),
        np.zeros(count),
        np.tile(layout.state_scale[: len(names)], repeats),
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
