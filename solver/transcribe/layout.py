"""Where a phase's decision variables stand: the one map between trajectories and vectors.

Segments of one kind (one transcription, one number of collocation points) make a strip; strips
share the variables of their common knots.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.mesh import Mesh
from solver.model import Interval, Phase
from solver.nlp.variables import Array, Indices
from solver.transcriptions.base import Transcription

Kind = Literal["state", "control", "algebraic", "native", "drift"]
KINDS: tuple[Kind, ...] = ("state", "control", "algebraic", "native", "drift")


@dataclass(frozen=True, slots=True)
class Edge:
    """A phase's start or end: its variable, None where the time is fixed, and its limits."""

    index: int | None
    limits: Interval


@dataclass(frozen=True, slots=True)
class TimeSymbols:
    """A phase's two times in one stage function."""

    start: SX
    end: SX

    def at(self, fraction: SX) -> SX:
        """The time at a fraction of the duration."""
        return self.start + (self.end - self.start) * fraction


@dataclass(frozen=True, slots=True)
class Shared:
    """What all stages of a phase share in one stage function: its times, the statics.

    ``symbols`` stacks what are variables, those at ``columns``.
    """

    times: TimeSymbols
    statics: SX
    symbols: SX
    columns: Indices


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
        Where each starts in the phase and how wide it is, fractions of the duration, (2, n).
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
        start, width = self.places
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

    def knot_columns(self) -> Indices:
        """What is shared at the knots, (variables, segments + 1)."""
        return np.concatenate([self.knots[kind] for kind in KINDS])

    def shared(self) -> Shared:
        """New symbols for times and statics; numbers for fixed times."""
        symbols: dict[int, SX] = {}

        def time(edge: Edge) -> SX:
            if edge.index is None:
                return SX(edge.limits.lower)
            return symbols.setdefault(edge.index, SX.sym("time"))

        times = TimeSymbols(time(self.start), time(self.end))
        statics = SX.sym("static", len(self.statics))
        return Shared(
            times,
            statics,
            ca.vertcat(SX(0, 1), *symbols.values(), statics),
            np.array([*symbols, *self.statics], dtype=int),
        )

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


def strips_of(transcription: Transcription, mesh: Mesh) -> Sequence[tuple[Transcription, Indices]]:
    """The segments of each kind: one strip, or one for each number of collocation points."""
    if mesh.degrees is None:
        return [(transcription, np.arange(mesh.segments))]
    return [
        (transcription.at_degree(int(degree)), np.flatnonzero(mesh.degrees == degree))
        for degree in np.unique(mesh.degrees)
    ]
