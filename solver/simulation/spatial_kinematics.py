"""Where links are at N points in time, how they move, and what moves them, in numpy.

For every link: its frame in the world, and the Jacobians of its origin and of its turning, with
the accelerations that are there when the coordinates' own are zero (``bias``). All vectors are in
the world's axes. Nothing is shared with ``solver.mechanics``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from schemas.urdf import WORLD, Carriage, Step
from schemas.urdf.algebra import IDENTITY
from solver.numeric.tape import Array


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame at N points.

    Attributes
    ----------
    place, axes
        Origin (N, 3), in m, and rotation to the world (N, 3, 3).
    moves, turns
        Jacobians of velocity and angular velocity, (N, 3, n).
    velocity, spin
        (N, 3), m/s and rad/s.
    bias, turning
        Acceleration and angular acceleration without those of the coordinates, (N, 3).
    """

    place: Array
    axes: Array
    moves: Array
    turns: Array
    velocity: Array
    spin: Array
    bias: Array
    turning: Array

    @classmethod
    def world(cls, points: int, coordinates: int) -> "Frame":
        """What does not move."""
        nothing, still = np.zeros((points, 3)), np.zeros((points, 3, coordinates))
        axes = np.tile(np.eye(3), (points, 1, 1))
        return cls(nothing, axes, still, still, nothing, nothing, nothing, nothing)

    def shifted(self, at: Array) -> "Frame":
        """The frame with its origin at a place of its own, (3,) or (N, 3)."""
        if not np.any(at):
            return self
        lever = (self.axes @ np.broadcast_to(at, self.place.shape)[..., None])[..., 0]
        dragged = crossed(self.spin, lever)
        return replace(
            self,
            place=self.place + lever,
            moves=self.moves - crossing(lever) @ self.turns,
            velocity=self.velocity + dragged,
            bias=self.bias + crossed(self.turning, lever) + crossed(self.spin, dragged),
        )

    def turned(self, axes: Array) -> "Frame":
        """The frame turned by a rotation of its own axes, (3, 3) or (N, 3, 3)."""
        return replace(self, axes=self.axes @ axes)

    def driven(self, turn: Array, rate: Array, column: int, factor: float) -> "Frame":
        """With an angular velocity along ``turn`` (N, 3) added, of size ``rate`` (N,)."""
        turns = self.turns.copy()
        turns[:, :, column] += factor * turn
        own = turn * rate[:, None]
        return replace(
            self, turns=turns, spin=self.spin + own, turning=self.turning + crossed(self.spin, own)
        )

    def pushed(self, along: Array, rate: Array, column: int, factor: float) -> "Frame":
        """With a velocity along ``along`` (N, 3) added, a direction that turns with the frame."""
        moves = self.moves.copy()
        moves[:, :, column] += factor * along
        own = along * rate[:, None]
        return replace(
            self,
            moves=moves,
            velocity=self.velocity + own,
            bias=self.bias + 2 * crossed(self.spin, own),
        )


@dataclass(frozen=True, slots=True)
class State:
    """Coordinates and velocities (n, N), and which row is whose."""

    rows: Mapping[str, int]
    q: Array
    v: Array

    def value(self, step: Step) -> tuple[Array, Array, int]:
        """Value and rate of a hinge or slide, (N,) each, and its coordinate."""
        row = self.rows[step.coordinates[0]]
        return step.factor * self.q[row] + step.offset, step.factor * self.v[row], row


def frames(carriages: Sequence[Carriage], state: State) -> dict[str, Frame]:
    """The frame of every link, parents first."""
    found = {WORLD: Frame.world(state.q.shape[1], len(state.q))}
    for one in carriages:
        frame = found[one.parent].shifted(np.array(one.pose.origin))
        if one.pose.axes != IDENTITY:
            frame = frame.turned(np.array(one.pose.axes))
        for step in one.steps:
            frame = _stepped(frame, step, state)
        found[one.link] = frame
    return found


def _stepped(frame: Frame, step: Step, state: State) -> Frame:
    if step.kind == "ball":
        return _ball(frame, step, state)
    value, rate, row = state.value(step)
    axis = np.array(step.axis)
    along = frame.axes @ axis
    if step.kind == "hinge":
        return frame.driven(along, rate, row, step.factor).turned(_rotation(axis, value))
    return frame.shifted(value[:, None] * axis).pushed(along, rate, row, step.factor)


def _rotation(axis: Array, angle: Array) -> Array:
    """About a unit vector, by Rodrigues' formula: (N, 3, 3)."""
    K = crossing(axis[None])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * K + (1 - c) * (K @ K))


def crossing(vectors: Array) -> Array:
    """The matrices of ``v x``, (N, 3, 3)."""
    found = np.zeros((len(vectors), 3, 3))
    found[:, 2, 1], found[:, 0, 2], found[:, 1, 0] = vectors.T
    found[:, 1, 2], found[:, 2, 0], found[:, 0, 1] = -vectors.T
    return found


def crossed(a: Array, b: Array) -> Array:
    """The vector products of (N, 3), at a fraction of what ``np.cross`` asks for a few."""
    found = np.empty(np.broadcast_shapes(a.shape, b.shape))
    found[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    found[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    found[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return found


def _ball(frame: Frame, step: Step, state: State) -> Frame:
    """By a quaternion p of any norm; in the axes before it w = 2 Im(p' p*) / |p|^2."""
    rows = [state.rows[name] for name in step.coordinates]
    p, rate = state.q[rows].T, state.v[rows].T
    size = np.sum(p * p, axis=1)
    scalar, vector = p[:, 0], p[:, 1:]
    K = crossing(vector)
    G = (
        np.concatenate([-vector[:, :, None], scalar[:, None, None] * np.eye(3) + K], axis=2)
        * (2 / size)[:, None, None]
    )
    own = np.einsum("nij,nj->ni", G, rate)
    drift = -2 * np.sum(p * rate, axis=1) / size
    turns = frame.turns.copy()
    turns[:, :, rows] += frame.axes @ G
    spin = np.einsum("nij,nj->ni", frame.axes, own)
    rotation = np.eye(3) + (2 / size)[:, None, None] * (scalar[:, None, None] * K + K @ K)
    moved = replace(
        frame,
        turns=turns,
        spin=frame.spin + spin,
        turning=frame.turning + crossed(frame.spin, spin) + drift[:, None] * spin,
    )
    return moved.turned(rotation)
