"""Where a phase's decision variables stand: the one map between trajectories and vectors."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.mesh import Mesh
from solver.model import Interval, Phase
from solver.nlp.scaling import typical_size
from solver.nlp.variables import Array, Indices, Variables
from solver.trajectory import Trajectory
from solver.transcriptions.base import Node, Transcription


@dataclass(frozen=True, slots=True)
class TimeSymbols:
    """A phase's two times in one stage function; ``free`` stacks those that are variables."""

    start: SX
    end: SX
    free: SX

    def at(self, fraction: SX) -> SX:
        """The time at a fraction of the duration."""
        return self.start + (self.end - self.start) * fraction


@dataclass(frozen=True, slots=True)
class PhaseLayout:
    """Indices of a phase's variables in the program.

    Attributes
    ----------
    states, controls
        One array (names, segments) per node of a segment, empty (0, segments) where the node
        carries no variable. Neighbouring segments share the variables of their common knot.
    times
        Indices of the initial and the final time; None where the time is fixed.
    state_scale
        Typical sizes of the states, shape (states,).
    """

    phase: Phase
    mesh: Mesh
    states: tuple[Indices, ...]
    controls: tuple[Indices, ...]
    times: tuple[int | None, int | None]
    state_scale: Array

    def segment_columns(self) -> Indices:
        """All variables of each segment, node by node, states before controls."""
        pairs = zip(self.states, self.controls, strict=True)
        return np.concatenate([array for pair in pairs for array in pair])

    def knot_columns(self) -> Indices:
        """States and controls at the knots, (variables, segments + 1); controls as shared."""
        first = np.concatenate([self.states[0], self.controls[0]])
        last = np.concatenate([self.states[-1], self.controls[-1]])
        return np.concatenate([first, last[:, -1:]], axis=1)

    def free_times(self) -> list[int]:
        """Indices of the times that are variables."""
        return [index for index in self.times if index is not None]

    def time_symbols(self) -> TimeSymbols:
        """New symbols for the free times, numbers for the fixed ones."""
        limits = (self.phase.start, self.phase.end)
        pairs = list(zip(limits, self.times, strict=True))
        start, end = (SX(side.lower) if at is None else SX.sym("time") for side, at in pairs)
        free = [end for end, at in zip((start, end), self.times, strict=True) if at is not None]
        return TimeSymbols(start, end, ca.vertcat(SX(0, 1), *free))


@dataclass(frozen=True, slots=True)
class Layouter:
    """Adds the variables of one phase to the table."""

    variables: Variables
    index: int
    phase: Phase
    mesh: Mesh
    guess: Trajectory

    def place(self, transcription: Transcription) -> PhaseLayout:
        """Add times, states and controls; where they stand."""
        phase, guess = self.phase, self.guess
        start = self._time("start", phase.start, guess.start)
        end = self._time("end", phase.end, guess.end)
        dense = self.mesh.fractions(np.linspace(0.0, 1.0, 5)).ravel()
        state_scale = self._sizes(phase.states, guess.sample_states(dense))
        control_scale = self._sizes(phase.controls, guess.sample_controls(dense))
        nodes, fractions = transcription.nodes, self.mesh.fractions(transcription.fractions)
        states = [
            self._block(phase.states, where, guess.sample_states(where), state_scale)
            if node.state
            else _nothing(self.mesh)
            for node, where in _places(nodes, fractions, shared=True)
        ]
        controls = [
            self._block(phase.controls, where, guess.sample_controls(where), control_scale)
            if node.control
            else _nothing(self.mesh)
            for node, where in _places(nodes, fractions, shared=transcription.shares_controls)
        ]
        return PhaseLayout(
            phase,
            self.mesh,
            _per_node(states, shared=True),
            _per_node(controls, shared=transcription.shares_controls),
            (start, end),
            state_scale,
        )

    def _time(self, name: str, limits: Interval, guess: float) -> int | None:
        if limits.fixed:
            return None
        sides = (np.full((1, 1), limits.lower), np.full((1, 1), limits.upper))
        scale = np.array([max(self.guess.end - self.guess.start, 1e-3)])
        at = np.array([np.nan])
        indices = self.variables.add(
            self.index, (f"{name} time",), at, sides, np.full((1, 1), guess), scale
        )
        return int(indices[0, 0])

    def _sizes(self, names: Sequence[str], samples: Array) -> Array:
        tables = (self.phase.bounds, self.phase.initial, self.phase.final)
        limits = [[side for table in tables for side in table[name]] for name in names]
        return typical_size(np.array(limits).reshape(len(names), 6), samples)

    def _block(self, names: tuple[str, ...], where: Array, guess: Array, scale: Array) -> Indices:
        """Variables of one node of every segment; with the end's limits at the phase's ends."""
        lower, upper = (np.empty_like(guess) for _ in range(2))
        for row, name in enumerate(names):
            lower[row], upper[row] = self.phase.bounds[name]
            if where[0] == 0.0:
                lower[row, 0], upper[row, 0] = self.phase.initial[name]
            if where[-1] == 1.0:
                lower[row, -1], upper[row, -1] = self.phase.final[name]
        return self.variables.add(self.index, names, where, (lower, upper), guess, scale)


def _places(
    nodes: Sequence[Node], fractions: Array, *, shared: bool
) -> Iterator[tuple[Node, Array]]:
    """Each block's node, and where in the phase it stands; shared knots are one block."""
    columns = list(fractions.T)
    if shared:
        columns = [np.append(columns[0], 1.0), *columns[1:-1]]
    yield from zip(nodes, columns, strict=not shared)


def _per_node(blocks: Sequence[Indices], *, shared: bool) -> tuple[Indices, ...]:
    """Per node of a segment; a block of shared knots serves as first and as last node."""
    if not shared:
        return tuple(blocks)
    knots, *inner = blocks
    return (knots[:, :-1], *inner, knots[:, 1:])


def _nothing(mesh: Mesh) -> Indices:
    return np.empty((0, mesh.segments), dtype=int)
