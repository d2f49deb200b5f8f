"""Bodies in space as lines in a picture: x to the right and z up, both in their true length.

What lies at greater y is moved a little to the right and up (an oblique projection): left and
right legs are told apart, and level ground stays level.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from footfall.curves import Floats
from footfall.report.looks import rods, styles

_RIGHT, _UP = 0.4, 0.2
"""How far a metre along y goes."""

Stick = tuple[str, Floats]
"""A colour, and where the ends are: x, y, x, y in the picture, (times, 4)."""


def read_poses(row: Mapping[str, Any]) -> tuple[Floats, Floats]:
    """Origins (times, 3) and rotations (times, 3, 3) of a body."""
    origins = np.array([row["x"], row["y"], row["z"]], dtype=float).T
    w, x, y, z = np.array(row["quaternion"], dtype=float).reshape(-1, 4).T
    rotations = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return origins, np.moveaxis(rotations, 2, 0)


def seen(places: Floats) -> Floats:
    """Places in space, (..., 3), as the picture has them, (..., 2)."""
    x, y, z = np.moveaxis(places, -1, 0)
    return np.stack([x + _RIGHT * y, z + _UP * y], axis=-1)


def place(pose: tuple[Floats, Floats], at: Sequence[float]) -> Floats:
    """A place of a body in the picture, (times, 2)."""
    origins, rotations = pose
    return seen(origins + rotations @ np.asarray(at, dtype=float))


def sticks(scene: Mapping[str, Any], poses: Mapping[str, tuple[Floats, Floats]]) -> Iterator[Stick]:
    """The rods of every body."""
    colours = styles(scene)
    for name, body in scene["bodies"].items():
        for start, end in rods(body):
            ends = [place(poses[name], at) for at in (start, end)]
            yield colours[name], np.concatenate(ends, axis=1)
