"""Where the links of a URDF system are, for drawing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import scipy  # loads scipy.spatial, which takes long, when it is first asked for

from schemas import resolve
from schemas.expressions import constant
from schemas.frames import (
    BodyLook,
    ContactLook,
    Frames,
    JointLook,
    Numbers,
    PlanarPoses,
    Point,
    Scene,
    SpatialArrow,
    SpatialPoses,
)
from schemas.urdf import WORLD, Urdf
from solver.numeric.tape import Array
from solver.simulation.frame_numbers import listed
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_kinematics import Frame


@dataclass(frozen=True, slots=True)
class _Numbers:
    """Centres (3,) and radii of contacts, and the height of the ground, in m."""

    centres: Mapping[str, Sequence[float]]
    radii: Mapping[str, float]
    height: float

    @classmethod
    def of(cls, system: Urdf, statics: Mapping[str, float]) -> "_Numbers":
        known = {**statics, **resolve.parameters(system)}
        contacts = system.contacts.items()
        return cls(
            {name: [constant(x.tree, known) for x in one.at] for name, one in contacts},
            {name: constant(one.radius.tree, known) for name, one in contacts},
            constant(system.ground.height.tree, known),
        )


_GROUND = "ground"
_NEAR = 1e-9


def spatial_frames(
    system: Urdf,
    statics: Mapping[str, float],
    times: Array,
    q: Array,
    pushes: Mapping[str, Array] = MappingProxyType({}),
) -> Frames:
    """Frames of every link at coordinates (n, N); ``pushes`` are forces of contacts, (3, N), in N.

    Raises ExpressionError, InvalidModel.
    """
    model = SpatialMultibody.of(system, statics)
    found = model.at(times, q).frames
    names = [one.link for one in system.carriages]
    poses: dict[str, PlanarPoses | SpatialPoses] = {name: _poses(found[name]) for name in names}
    across = np.concatenate([found[name].place[:, 0] for name in names])
    numbers = _Numbers.of(system, statics)
    return Frames(
        time=times.tolist(),
        bodies=poses,
        forces={
            name: _arrow(found[system.contacts[name].link], numbers, name, push)
            for name, push in pushes.items()
        },
        scene=_scene(system, numbers, across),
    )


def _arrow(frame: Frame, numbers: "_Numbers", name: str, push: Array) -> SpatialArrow:
    """A force where its contact touches level ground: below the middle of a sphere."""
    places = frame.place + frame.axes @ np.array(numbers.centres[name])
    x, y, z = places.T
    fx, fy, fz = (listed(row) for row in push)
    below = listed(z - numbers.radii[name])
    return SpatialArrow(x=listed(x), y=listed(y), z=below, fx=fx, fy=fy, fz=fz)


def _poses(frame: Frame) -> SpatialPoses:
    x, y, z = (listed(row) for row in frame.place.T)
    return SpatialPoses(x=x, y=y, z=z, quaternion=_quaternions(frame.axes))


def _quaternions(axes: Array) -> list[Numbers]:
    """(w, x, y, z) of rotations (N, 3, 3), without jumps of sign; null where there is none."""
    known = np.isfinite(axes).all(axis=(1, 2))
    rows = np.full((len(axes), 4), np.nan)
    if known.any():
        rows[known] = scipy.spatial.transform.Rotation.from_matrix(axes[known]).as_quat()[
            :, [3, 0, 1, 2]
        ]
    kept = np.flatnonzero(known)
    turned = np.sum(rows[kept[1:]] * rows[kept[:-1]], axis=1) < 0
    rows[kept[1:]] *= np.where(np.cumsum(turned) % 2 == 1, -1.0, 1.0)[:, None]
    return [listed(row) for row in rows]


def _scene(system: Urdf, numbers: "_Numbers", across: Array) -> Scene:
    return Scene(
        bodies={one.link: _look(system, numbers, one.link) for one in system.carriages},
        joints={
            one.joint: JointLook(
                kind="revolute", body=one.parent, child=one.link, at=_point(one.pose.origin)
            )
            for one in system.carriages
            if one.parent != WORLD and any(step.kind == "hinge" for step in one.steps)
        },
        contacts={
            name: ContactLook(
                body=one.link,
                at=_point(numbers.centres[name]),
                radius=numbers.radii[name],
            )
            for name, one in system.contacts.items()
        },
        surfaces={_GROUND: _ground(across, numbers.height)} if system.contacts else {},
    )


def _look(system: Urdf, numbers: "_Numbers", name: str) -> BodyLook:
    """A link from its own joint, which is its origin, to those of its children and contacts."""
    link = system.tree.links[name]
    places = [
        (0.0, 0.0, 0.0),
        *(one.pose.origin for one in system.carriages if one.parent == name),
        *(numbers.centres[key] for key, one in system.contacts.items() if one.link == name),
    ]
    points = [_point(place) for place in places]
    apart = [p for i, p in enumerate(points) if p not in points[:i]]
    return BodyLook(places=apart, com=_point(link.com) if link.mass > _NEAR else None)


def _ground(across: Array, height: float) -> list[Point]:
    finite = across[np.isfinite(across)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
    pad = max(high - low, 1.0)
    return [_point((low - pad, 0.0, height)), _point((high + pad, 0.0, height))]


def _point(place: object) -> Point:
    return [float(f"{x:.9g}") for x in np.asarray(place, dtype=float)]
