"""True changes of places and rotations over a step as rows of the coordinates' changes.

Where two things are multiplied, the change of their product is the mean of each times the change
of the other, whatever the step. Along the tree, from the base to the tips, that gives for every
frame rows that times the step are the change of its place and of its rotation: exactly.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from schemas.urdf import WORLD, Carriage, Step
from schemas.urdf.algebra import IDENTITY
from solver.numeric import Array
from solver.simulation.spatial_kinematics import crossing


@dataclass(frozen=True, slots=True)
class SlopeFrame:
    """A frame over N steps.

    Attributes
    ----------
    axes
        Its rotations at both ends, (2, N, 3, 3).
    moves, turns
        Rows of its place, (N, 3, n), and of its rotation's entries, (N, 3, 3, n).
    """

    axes: Array
    moves: Array
    turns: Array

    @classmethod
    def world(cls, steps: int, coordinates: int) -> "SlopeFrame":
        """What does not move."""
        axes = np.tile(np.eye(3), (2, steps, 1, 1))
        return cls(axes, np.zeros((steps, 3, coordinates)), np.zeros((steps, 3, 3, coordinates)))

    @property
    def mean(self) -> Array:
        """Of both ends, (N, 3, 3)."""
        return np.asarray((self.axes[0] + self.axes[1]) / 2)

    def shifted(self, at: Array) -> "SlopeFrame":
        """With its origin at a place of its own, (3,) or (N, 3) with means over the steps."""
        lever = np.broadcast_to(at, (len(self.moves), 3))
        return replace(self, moves=self.moves + np.einsum("Nijq,Nj->Niq", self.turns, lever))

    def turned(self, turn: Array) -> "SlopeFrame":
        """Turned in its own axes: (3, 3), or at both ends (2, N, 3, 3)."""
        axes = np.broadcast_to(turn, self.axes.shape)
        turns = np.einsum("Nijn,Njk->Nikn", self.turns, (axes[0] + axes[1]) / 2)
        return replace(self, axes=self.axes @ axes, turns=turns)

    def rolled(self, *, own: bool = False) -> Array:
        """Rows of the vector by which it turns, in the world's or its own axes, (N, 3, n).

        Of less than half a turn.
        """
        mean, turns, (R0, R1) = self.mean, self.turns, self.axes
        turn = R1 @ np.swapaxes(R0, 1, 2)
        if own:
            skew = np.einsum("Nri,Nrjn->Nijn", mean, turns)
        else:
            skew = np.einsum("Nirn,Njr->Nijn", turns, mean)
        rows = [skew[:, i, j] - skew[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))]
        across = turn - np.swapaxes(turn, 1, 2)
        sine = np.linalg.norm(across, axis=(1, 2)) / np.sqrt(8)
        angle = np.arctan2(sine, (np.trace(turn, axis1=1, axis2=2) - 1) / 2)
        grown = np.divide(angle, sine, out=np.ones_like(sine), where=sine > 0)
        return np.asarray(grown[:, None, None] * np.stack(rows, axis=1) / 2)


def slope_frames(carriages: list[Carriage], names: list[str], q: Array) -> dict[str, SlopeFrame]:
    """The frame of every link; ``q`` are the coordinates at the knots, (n, N + 1)."""
    found = {WORLD: SlopeFrame.world(q.shape[1] - 1, len(q))}
    for one in carriages:
        frame = found[one.parent].shifted(np.array(one.pose.origin))
        if one.pose.axes != IDENTITY:
            frame = frame.turned(np.array(one.pose.axes))
        for step in one.steps:
            frame = _stepped(frame, step, [names.index(name) for name in step.coordinates], q)
        found[one.link] = frame
    return found


def _stepped(frame: SlopeFrame, step: Step, rows: list[int], q: Array) -> SlopeFrame:
    if step.kind == "ball":
        p = q[rows].T
        slopes = np.stack(list(_quadratic_rows((p[1:] + p[:-1]) / 2)), axis=3)
        return _turned(frame, _ends(_rotations(p)), slopes, rows)
    value, axis = step.factor * q[rows[0]] + step.offset, np.array(step.axis)
    mean, half = (value[1:] + value[:-1]) / 2, np.diff(value) / 2
    if step.kind == "slide":
        moved = frame.shifted(mean[:, None] * axis)
        moves = moved.moves.copy()
        moves[:, :, rows[0]] += step.factor * frame.mean @ axis
        return replace(moved, moves=moves)
    K = crossing(axis[None])[0]
    s, c = (part(value)[:, None, None] for part in (np.sin, np.cos))
    turns = np.eye(3) + s * K + (1 - c) * K @ K
    s, c = (part(mean)[:, None, None] for part in (np.sin, np.cos))
    share = step.factor * np.sinc(half / np.pi)[:, None, None]
    slopes = (share * (c * K + s * K @ K))[..., None]
    return _turned(frame, _ends(turns), slopes, rows)


def _turned(frame: SlopeFrame, turns: Array, slopes: Array, rows: list[int]) -> SlopeFrame:
    """By rotations at both ends, with the rows of their entries, (N, 3, 3, len(rows))."""
    found = frame.turned(turns)
    whole = found.turns.copy()
    whole[..., rows] += np.einsum("Nij,Njkr->Nikr", frame.mean, slopes)
    return replace(found, turns=whole)


def _ends(values: Array) -> Array:
    return np.stack([values[:-1], values[1:]])


def _rotations(p: Array) -> Array:
    """Of quaternions (N, 4) of norm 1, (N, 3, 3)."""
    K = crossing(p[:, 1:])
    return np.asarray(np.eye(3) + 2 * (p[:, :1, None] * K + K @ K))


def _quadratic_rows(p: Array) -> Iterator[Array]:
    """The derivatives of that by each entry; at the mean of two they give the change."""
    K = crossing(p[:, 1:])
    yield 2 * K
    for axis in np.eye(3):
        unit = crossing(axis[None])
        yield 2 * (p[:, :1, None] * unit + unit @ K + K @ unit)
