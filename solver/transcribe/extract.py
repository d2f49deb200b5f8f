"""The NLP's point -> trajectories: the one place where arrays turn from CasADi's order."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from footfall.curves import Curve, Curves, fit
from schemas.results import CurveGroup, Group, PhaseResult, finite
from solver.trajectory import Trajectory
from solver.transcribe.layout import Edge, PhaseLayout, Strip
from solver.transcribe.transcribe import Transcribed
from solver.transcriptions.base import Transcription

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Nodes:
    """A strip at all nodes of its segments: x, f, u, z (segments, nodes, names).

    ``integrals`` (integrals, segments) are the shares of each segment.
    """

    x: Array
    f: Array
    u: Array
    z: Array
    integrals: Array


@dataclass(frozen=True, slots=True)
class Extracted:
    """One phase: its trajectory, its result, and ``sums`` (integrals, segments) of its method."""

    trajectory: Trajectory
    result: PhaseResult
    sums: Array


def extract(transcribed: Transcribed, w: Array) -> list[Extracted]:
    """Read the trajectories of all phases out of the decision variables ``w`` (SI)."""
    phases = []
    for index, layout in enumerate(transcribed.layouts):
        strips = [_evaluate(transcribed, index, number, w) for number in range(len(layout.strips))]
        start, end = (_time(edge, w) for edge in (layout.start, layout.end))
        end = max(start, end)  # an iterate may break the least duration
        trajectory, sums = _trajectory(layout, strips, start, end), _sums(layout, strips)
        result = _result(layout, strips, trajectory, sums)
        phases.append(Extracted(trajectory, result, sums))
    return phases


def _sums(layout: PhaseLayout, strips: Sequence[_Nodes]) -> Array:
    sums = np.empty((len(layout.phase.integrals), layout.mesh.segments))
    for strip, nodes in zip(layout.strips, strips, strict=True):
        sums[:, strip.where] = nodes.integrals
    return sums


def _time(edge: Edge, w: Array) -> float:
    return edge.limits.lower if edge.index is None else float(w[edge.index])


def _evaluate(transcribed: Transcribed, phase: int, number: int, w: Array) -> _Nodes:
    group = transcribed.segments[phase][number]
    strip = transcribed.layouts[phase].strips[number]
    segments, count = len(strip.where), len(strip.transcription.nodes)
    outputs = transcribed.nodes[phase][number].map(segments)(w[group.columns], group.data)

    def turned(matrix: Array) -> Array:
        """(names, segments * nodes) -> (segments, nodes, names)."""
        return np.moveaxis(matrix.reshape(len(matrix), segments, count), 0, 2)

    x, f, u, z, integrals = (output.full() for output in outputs)
    return _Nodes(turned(x), turned(f), turned(u), turned(z), integrals)


def _trajectory(
    layout: PhaseLayout, strips: Sequence[_Nodes], start: float, end: float
) -> Trajectory:
    phase, whole = layout.phase, layout.transcription
    lengths = (end - start) * np.diff(layout.mesh.knots)
    pieces = np.full(layout.mesh.segments, whole.pieces)
    breaks = start + (end - start) * layout.mesh.subdivide(pieces).knots

    def curves(names: Sequence[str], make: Callable[[Strip, _Nodes], Array]) -> Curves:
        parts = [make(*pair) for pair in zip(layout.strips, strips, strict=True)]
        return Curves(breaks, dict(zip(names, _merged(layout, parts), strict=True)))

    return Trajectory(
        start,
        end,
        curves(
            phase.states,
            lambda strip, nodes: strip.transcription.state_curve(
                nodes.x, nodes.f, lengths[strip.where, None]
            ),
        ),
        curves(
            phase.controls,
            lambda strip, nodes: strip.transcription.control_curve(
                nodes.u, lengths[strip.where, None]
            ),
        ),
        curves(
            phase.algebraic,
            lambda strip, nodes: _algebraic_curve(
                strip.transcription, nodes.z[:, :, : len(phase.algebraic)]
            ),
        )
        if strips[0].z.shape[2]
        else Curves(breaks, {}),
    )


def _algebraic_curve(transcription: Transcription, z: Array) -> Array:
    """The polynomial through the nodes with such variables."""
    which = [i for i, node in enumerate(transcription.nodes) if node.algebraic]
    return fit(2 * transcription.fractions[which] - 1, z[:, which])


def _merged(layout: PhaseLayout, parts: Sequence[Array]) -> Array:
    """Coefficients of all segments in order, padded to one degree: (series, pieces, terms)."""
    if len(parts) == 1:
        return parts[0]
    terms = max(part.shape[2] for part in parts)
    merged = np.zeros((len(parts[0]), layout.mesh.segments, terms))
    for strip, part in zip(layout.strips, parts, strict=True):
        merged[:, strip.where, : part.shape[2]] = part
    return merged


def _result(
    layout: PhaseLayout, strips: Sequence[_Nodes], trajectory: Trajectory, sums: Array
) -> PhaseResult:
    phase, duration = layout.phase, trajectory.end - trajectory.start
    table = _node_table(layout, strips, trajectory)
    published = {
        group: names
        for group, names in phase.chain.publish.items()
        if names or group in ("states", "controls")
    }
    if not trajectory.others:  # forces, where the method has no variables for them
        published.pop("forces", None)
    return PhaseResult(
        name=phase.name,
        knots=(trajectory.start + duration * layout.mesh.knots).tolist(),
        groups={group: table(names) for group, names in published.items()},
        curves={group: _curve_group(trajectory, names) for group, names in published.items()},
        integrals={
            name: finite(value)
            for name, value in zip(phase.integrals, sums.sum(axis=1), strict=True)
        },
    )


def _curve_group(trajectory: Trajectory, names: Sequence[str]) -> CurveGroup:
    found: dict[str, Curve] = {}
    for name in names:
        curve = trajectory.curve(name)
        if curve is None:
            raise LookupError(f"no curve of {name}")
        found[name] = curve
    breaks = trajectory.states.breaks
    curves = Curves(breaks, {name: curve.coefficients for name, curve in found.items()})
    return CurveGroup.model_validate(curves.to_dict())


def _node_table(
    layout: PhaseLayout, strips: Sequence[_Nodes], trajectory: Trajectory
) -> Callable[[Sequence[str]], Group]:
    """A function from names to their values at all nodes; at inner knots, of the later segment."""
    where, fraction = _node_places(layout)
    segment, place = where
    order = np.lexsort((segment, segment + place))
    keep = order[~np.append(np.diff((segment + place)[order]) == 0, False)]
    duration = trajectory.end - trajectory.start
    time = (trajectory.start + duration * fraction[keep]).tolist()
    columns: dict[str, Array] = {}
    for names, attribute in ((layout.phase.states, "x"), (layout.phase.controls, "u")):
        stacked = np.concatenate(
            [
                values.reshape(values.shape[0] * values.shape[1], len(names))
                for values in (getattr(nodes, attribute) for nodes in strips)
            ]
        )
        columns |= {name: stacked[keep, i] for i, name in enumerate(names)}

    def group(names: Sequence[str]) -> Group:
        values = {
            name: columns[name] if name in columns else trajectory.sample([name], fraction[keep])[0]
            for name in names
        }
        return Group(
            time=time, values={name: [finite(v) for v in row] for name, row in values.items()}
        )

    return group


def _node_places(layout: PhaseLayout) -> tuple[Array, Array]:
    """Each node's segment and its place there (2, n), its fraction of the phase (n,); by strips."""
    where, fractions = [], []
    for strip in layout.strips:
        nodes = strip.transcription.fractions
        where.append([np.repeat(strip.where, len(nodes)), np.tile(nodes, len(strip.where))])
        fractions.append(strip.fractions(nodes).ravel())
    return np.concatenate(where, axis=1), np.concatenate(fractions)
