"""Where a phase's decision variables stand: the one map between trajectories and vectors.

Segments of one kind (one transcription, one number of collocation points) make a strip; strips
share the variables of their common knots.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from solver.frozen import frozen
from solver.mesh import Mesh
from solver.model import Interval, Phase
from solver.model.shape import PhaseShape
from solver.nlp.variables import Array, Indices
from solver.transcribe.stage import KINDS, Kind, Stage, StageShape, TimeKind, stage_of
from solver.transcriptions.base import Transcription


@dataclass(frozen=True, slots=True)
class Edge:
    """A phase's start or end: its variable, None where the time is fixed, and its limits."""

    index: int | None
    limits: Interval


@dataclass(frozen=True, slots=True)
class Shared:
    """What all stages of a phase share, as numbers to its symbols (``stage.SharedSymbols``).

    ``columns`` are the variables behind the free times and the statics; ``values`` are those of
    the fixed times that are not zero and of the phase's constants.
    """

    times: tuple[TimeKind, TimeKind]
    columns: Indices
    values: Array


@dataclass(frozen=True, slots=True)
class Strip:
    """Segments of one kind.

    Attributes
    ----------
    transcription
        Of these segments.
    where
        Which segments of the phase they are, shape (segments of the strip,).
    places
        Where each starts in the phase, how wide it is, and how wide the one before it:
        fractions of the duration, (3, n).
    blocks
        Kind of variable -> one array (names, n) per node, empty (0, n) where the node carries no
        variable of this kind.
    """

    transcription: Transcription
    where: Indices
    places: Array
    blocks: dict[Kind, tuple[Indices, ...]]

    def columns(self) -> Indices:
        """All variables of each segment, node by node, kind by kind."""
        return np.concatenate(list(self._parts()))

    def at_node(self, node: int) -> Indices:
        """All variables of one node of each segment."""
        return np.concatenate([self.blocks[kind][node] for kind in KINDS])

    def _parts(self) -> Iterator[Indices]:
        for node in range(len(self.transcription.nodes)):
            yield from (self.blocks[kind][node] for kind in KINDS)

    def fractions(self, nodes: Array) -> Array:
        """Where nodes in [0, 1] of every segment lie in the phase: (segments, nodes)."""
        start, width, _ = self.places
        return np.asarray(start[:, None] + width[:, None] * nodes[None, :])


@dataclass(frozen=True, slots=True)
class PhaseLayout:
    """Indices of a phase's variables in the program.

    Attributes
    ----------
    knots
        Kind of variable -> its indices at the knots where neighbours share them, shape
        (names, segments + 1); empty where they do not.
    start, end
        The phase's times. A later phase's start is the end of the phase before.
    statics
        Indices of the problem's statics.
    state_scale
        Typical sizes of the states, shape (states,).
    shape, constants
        What the phase's functions are built from, and the numbers to be put into them.
    """

    phase: Phase
    mesh: Mesh
    transcription: Transcription
    strips: tuple[Strip, ...]
    knots: dict[Kind, Indices]
    start: Edge
    end: Edge
    statics: tuple[int, ...]
    state_scale: Array
    shape: PhaseShape
    constants: tuple[float, ...]

    def knot_columns(self) -> Indices:
        """What is shared at the knots, (variables, segments + 1)."""
        return np.concatenate([self.knots[kind] for kind in KINDS])

    def shared(self) -> Shared:
        """Where its variables stand, and the numbers of its constants."""
        edges = (self.start, self.end)
        free = [edge.index for edge in edges if edge.index is not None]
        times = [edge.limits.lower for edge in edges if edge.index is None]
        return Shared(
            (_kind(self.start), _kind(self.end)),
            np.array([*free, *self.statics], dtype=int),
            np.array([*(time for time in times if time != 0), *self.constants]),
        )

    def stage_shape(self, strip: "Strip") -> StageShape:
        """What the symbols of a strip's segments are built from."""
        sizes = tuple(
            tuple(len(strip.blocks[kind][node]) for kind in KINDS)
            for node in range(len(strip.transcription.nodes))
        )
        method = strip.transcription
        return StageShape(
            phase=self.shape,
            method=frozen(method),
            eliminates=method.eliminates,
            shares_controls=method.shares_controls,
            sizes=sizes,
            times=self.shared().times,
        )

    def stage(self, strip: "Strip") -> Stage:
        """The symbols of a strip's segments."""
        return stage_of(self.stage_shape(strip), strip.transcription)

    def ends(self) -> tuple[tuple[Strip, int], tuple[Strip, int]]:
        """The strips of the first and of the last segment, and the segments' places in them."""
        last = self.mesh.segments - 1
        return self._find(0), self._find(last)

    def _find(self, segment: int) -> tuple[Strip, int]:
        for strip in self.strips:
            place = int(np.searchsorted(strip.where, segment))
            if place < len(strip.where) and strip.where[place] == segment:
                return strip, place
        raise LookupError(f"segment {segment} is in no strip")


def _kind(edge: Edge) -> TimeKind:
    if edge.index is not None:
        return "free"
    return "zero" if edge.limits.lower == 0 else "fixed"


def strips_of(transcription: Transcription, mesh: Mesh) -> Sequence[tuple[Transcription, Indices]]:
    """The segments of each kind: as the method has them, or by number of collocation points."""
    if mesh.degrees is None:
        return transcription.strips(mesh.segments)
    return [
        (transcription.at_degree(int(degree)), np.flatnonzero(mesh.degrees == degree))
        for degree in np.unique(mesh.degrees)
    ]
