"""The motion of a result's bodies, read for drawing: poses, paths, what has to be in view."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from footfall.curves import Floats
from footfall.report.looks import Piece, corners, pieces, styles, typical_length
from footfall.report.space import Stick, place, read_poses, seen, sticks

_MARGIN = 0.07  # of the view's larger side, around all that moves
_ARROW = 0.22  # a large force over the view's smaller side
_CUT = 4.0  # arrows are at most so many times as long: impacts last for a step and are huge
_FORCE = ("fx", "fy", "fz")
_SLIGHT = 1e-3  # forces below this share of the largest do not count among the large ones
_WIDE = 25.0  # a view so many times the bodies' size follows them
_WINDOW = 8.0  # the width of the view that follows, over the bodies' size


@dataclass(frozen=True)
class Box:
    """A part of the world, in m."""

    left: float
    low: float
    right: float
    high: float

    @property
    def width(self) -> float:
        """M."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """M."""
        return self.high - self.low


@dataclass(frozen=True)
class Clip:
    """The motion of one phase.

    ``poses`` are x, y and angle of each body, (times, 3), with the ground; ``forces`` are x, y,
    fx and fy, (times, 4); ``springs`` have two ends, each a body and a place of it. ``traces`` are
    the ways of the centres of mass, each with its colour. What moves in space is ``sticks``.
    """

    name: str
    time: Floats
    poses: dict[str, Floats]
    pieces: list[Piece]
    springs: list[tuple[tuple[str, Floats], tuple[str, Floats]]]
    surfaces: list[Floats]
    forces: dict[str, Floats]
    scene: Mapping[str, Any]
    traces: list[tuple[str, Floats]]
    sticks: list[Stick] = field(default_factory=list)

    def place(self, body: str, at: Any) -> Floats:
        """A place of a body in the world, (times, 2)."""
        return _placed(self.poses[body], at)


@dataclass(frozen=True)
class Motion:
    """All phases that have frames, in their order.

    ``size`` is the typical length of a body, ``follow`` the width of a view that goes along with
    bodies which travel far (None: they do not), ``newton`` how long an arrow of 1 N is in m; where
    forces are ``cut``, the longest arrows would be longer.
    """

    clips: list[Clip]
    view: Box
    size: float
    follow: float | None
    newton: float
    cut: bool = False

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last time, in s."""
        return float(self.clips[0].time[0]), float(self.clips[-1].time[-1])


def motion_of(result: Mapping[str, Any]) -> Motion | None:
    """The motion of a result; None where nothing has frames."""
    found = [_read(phase) for phase in result["phases"] if phase.get("frames")]
    clips = [clip for clip in found if len(clip.time)]
    if not clips:
        return None
    size = max(typical_length(clip.scene) for clip in clips)
    view = _view(clips, size)
    travels = max(view.width, view.height) > _WIDE * size
    follow = _WINDOW * size if travels else None
    smaller = min(view.width, view.height, 3 * size)
    large, largest = _large_forces(clips)
    cut = largest > _CUT * large
    clips = [_cut(clip, _CUT * large) for clip in clips] if cut else clips
    return Motion(clips, view, size, follow, _ARROW * smaller / large, cut)


def _read(phase: Mapping[str, Any]) -> Clip:
    planar = all("angle" in poses for poses in phase["frames"]["bodies"].values())
    return _clip(phase) if planar else _clip_in_space(phase)


def _clip_in_space(phase: Mapping[str, Any]) -> Clip:
    frames = phase["frames"]
    scene, colours = frames["scene"], styles(frames["scene"])
    poses = {name: read_poses(row) for name, row in frames["bodies"].items()}
    time = np.asarray(frames["time"], dtype=float)
    drawn = list(sticks(scene, poses))
    known = np.isfinite(time)
    for _, rows in drawn:
        known &= np.isfinite(rows).all(axis=1)
    looks = scene["bodies"].items()
    traces = [
        (colours[name], place(poses[name], look["com"])) for name, look in looks if look["com"]
    ]
    return Clip(
        name=phase["name"],
        time=time[known],
        poses={"ground": np.zeros((known.sum(), 3))},
        pieces=[],
        springs=[],
        surfaces=[seen(np.array(line, dtype=float)) for line in scene["surfaces"].values()],
        forces={
            name: np.column_stack([seen(_columns(row, *word)) for word in ("xyz", _FORCE)])[known]
            for name, row in frames["forces"].items()
        },
        scene=scene,
        traces=[(colour, rows[known]) for colour, rows in traces],
        sticks=[(colour, rows[known]) for colour, rows in drawn],
    )


def _clip(phase: Mapping[str, Any]) -> Clip:
    frames = phase["frames"]
    scene = frames["scene"]
    poses = {name: _columns(row, "x", "y", "angle") for name, row in frames["bodies"].items()}
    known = np.ones(len(frames["time"]), dtype=bool)
    for rows in poses.values():
        known &= np.isfinite(rows).all(axis=1)
    kept = {name: rows[known] for name, rows in poses.items()}
    time = np.asarray(frames["time"], dtype=float)[known]
    springs = [
        tuple((end["body"], np.asarray(end["at"], dtype=float)) for end in ends)
        for ends in scene["springs"].values()
    ]
    return Clip(
        name=phase["name"],
        time=time,
        poses={"ground": np.zeros((len(time), 3)), **kept},
        pieces=pieces(scene),
        springs=[(ends[0], ends[1]) for ends in springs],
        surfaces=[np.asarray(line, dtype=float) for line in scene["surfaces"].values() if line],
        forces={
            name: _columns(row, "x", "y", "fx", "fy")[known]
            for name, row in frames["forces"].items()
        },
        scene=scene,
        traces=[
            (colour, _placed(kept[name], look["com"]))
            for (name, look), colour in zip(
                scene["bodies"].items(), styles(scene).values(), strict=True
            )
            if look["com"]
        ],
    )


def _placed(poses: Floats, at: Any) -> Floats:
    """A place of a body whose poses are known, (times, 2)."""
    x, y, angle = poses.T
    across, up = (float(part) for part in at)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([x + cosine * across - sine * up, y + sine * across + cosine * up])


def _columns(table: Mapping[str, Sequence[float | None]], *names: str) -> Floats:
    return np.column_stack([np.array(table[name], dtype=float) for name in names])


def _view(clips: Sequence[Clip], size: float) -> Box:
    """What holds all that moves, with a margin."""
    points = np.concatenate([rows for clip in clips for rows in _extents(clip)])
    low, high = points.min(axis=0), points.max(axis=0)
    pad = max(_MARGIN * float(max(high - low)), 0.15 * size)
    left, foot, right, top = (float(edge) for edge in (*(low - pad), *(high + pad)))
    return Box(left, foot, right, top)


def _extents(clip: Clip) -> Iterator[Floats]:
    yield np.zeros((0, 2))
    if clip.sticks or not clip.pieces:
        yield from (rows.reshape(-1, 2) for _, rows in (*clip.sticks, *clip.traces))
        return
    for name, body in clip.scene["bodies"].items():
        for at in corners(body):
            yield clip.place(name, at)
    for joint in clip.scene["joints"].values():
        for at in (joint["at"], joint["end"] or joint["at"]):
            yield clip.place(joint["body"], at)
    for ends in clip.springs:
        for carrier, spot in ends:
            yield clip.place(carrier, spot)
    round_ones = [*clip.scene["contacts"].values(), *clip.scene["shapes"].values()]
    for look in round_ones:
        reach = max(look.get("axes") or [look["radius"]])
        centre = clip.place(look["body"], look["at"])
        yield centre - reach
        yield centre + reach


def _large_forces(clips: Sequence[Clip]) -> tuple[float, float]:
    """The 95th percentile of the forces that act, and their largest, in N.

    So one peak does not hide the others, and those that are nearly nothing do not count.
    """
    sizes = [np.hypot(*rows[:, 2:].T) for clip in clips for rows in clip.forces.values()]
    acting = np.concatenate([np.zeros(0), *sizes])
    acting = acting[np.isfinite(acting) & (acting > 1e-9)]
    if not len(acting):
        return 1.0, 1.0
    largest = float(acting.max())
    return float(np.percentile(acting[acting > _SLIGHT * largest], 95)), largest


def _cut(clip: Clip, most: float) -> Clip:
    """The forces made no larger than ``most``, in N, in their directions."""
    forces = {}
    for name, rows in clip.forces.items():
        sizes = np.hypot(*rows[:, 2:].T)
        share = np.minimum(1.0, most / np.where(sizes > most, sizes, most))
        forces[name] = np.column_stack([rows[:, :2], rows[:, 2:] * share[:, None]])
    return replace(clip, forces=forces)
