"""Where the bodies of a system are along published curves: all that a drawing needs."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from footfall.curves import Curve
from schemas.errors import InvalidModel
from schemas.expressions import ExpressionError
from schemas.frames import Arrow, Frames, PlanarPoses, SpatialArrow
from schemas.mechanisms import Mechanism
from schemas.results import PhaseResult
from schemas.systems import System
from schemas.urdf import Urdf
from solver.numeric.tape import Array
from solver.simulation.constants import Constants
from solver.simulation.frame_numbers import listed
from solver.simulation.instant import Instant
from solver.simulation.multibody import Multibody
from solver.simulation.scene import Span, scene_of
from solver.simulation.spatial_frames import spatial_frames

_RATE = 60.0
_FEWEST, _MOST = 20, 600
_BENDS = 200  # knots; of more, a mesh is so fine that none stands out


def with_frames(result: PhaseResult, system: System, statics: Mapping[str, float]) -> PhaseResult:
    """The phase with the frames of its motion, if its system has bodies and it has curves.

    A drawing is an extra: where the judge cannot read the mechanism, there is none.
    """
    if not isinstance(system, Mechanism | Urdf) or len(result.knots) < 2:
        return result
    times = _times(result.knots)
    q = _series(result, system.coordinates, times, ("states",))
    if q is None:
        return result
    try:
        with np.errstate(all="ignore"):  # a trajectory that diverged is drawn as far as it goes
            frames = (
                _frames(system, statics, result, times, q)
                if isinstance(system, Mechanism)
                else spatial_frames(system, statics, times, q, _pushes(system, result, times))
            )
    except (ExpressionError, InvalidModel):
        return result
    return result.model_copy(update={"frames": frames})


def _frames(
    mechanism: Mechanism,
    statics: Mapping[str, float],
    result: PhaseResult,
    times: Array,
    q: Array,
) -> Frames:
    multibody, constants = Multibody.of(mechanism, statics), Constants.of(mechanism, statics)
    now = multibody.at(times, q)
    poses = multibody.frames(q)
    travel = {name: _span(row) for name, row in zip(multibody.coordinates, q, strict=True)}
    return Frames(
        time=times.tolist(),
        bodies={
            name: PlanarPoses(x=listed(x), y=listed(y), angle=listed(angle))
            for name, (x, y, angle) in zip(multibody.bodies, poses, strict=True)
        },
        forces=_forces(multibody, result, times, now),
        scene=scene_of(mechanism, constants, travel, _reach(poses, now)),
    )


def _times(knots: Sequence[float]) -> Array:
    """60 in a second, but not too few and not too many; and the knots, where motions bend."""
    start, end = knots[0], knots[-1]
    count = math.ceil(_RATE * (end - start)) + 1
    equal = np.linspace(start, end, min(_MOST, max(_FEWEST, count)))
    return np.union1d(equal, knots) if len(knots) <= _BENDS else equal


def _series(
    result: PhaseResult, names: Sequence[str], times: Array, groups: tuple[str, ...]
) -> Array | None:
    """Series by name at some times, (names, times); None if one has no curve."""
    rows = []
    for name in names:
        for group in groups:
            curves = result.curves.get(group)
            if curves is not None and name in curves.coefficients:
                rows.append(Curve(curves.breaks, _floats(curves.coefficients[name]))(times))
                break
        else:
            return None
    return np.array(rows)


def _floats(rows: list[list[float | None]]) -> Array:
    return np.array(rows, dtype=float)


def _forces(
    multibody: Multibody, result: PhaseResult, times: Array, now: Instant
) -> dict[str, Arrow | SpatialArrow]:
    """The published forces of contacts as vectors in the world, at the contacts."""
    touch = multibody.parts.touch
    if not touch.names:
        return {}
    places = touch.places[0] @ now.pose.features
    normals = now.contacts.normals
    places = places - touch.radii[:, None] * normals
    found: dict[str, Arrow | SpatialArrow] = {}
    for row, name in enumerate(touch.names):
        pushes = [
            _force(result, f"contact.{name}.{way}", times) for way in ("normal", "tangential")
        ]
        normal, tangential = pushes
        if normal is None:
            continue
        along = 0.0 if tangential is None else tangential
        force = normals[row] * (normal - 1j * along)
        found[name] = Arrow(
            x=listed(places[row].real),
            y=listed(places[row].imag),
            fx=listed(force.real),
            fy=listed(force.imag),
        )
    return found


def _pushes(system: Urdf, result: PhaseResult, times: Array) -> dict[str, Array]:
    """The published forces of contacts in space, along x, y and z, (3, times)."""
    found = {}
    for name in system.contacts:
        normal = _force(result, f"contact.{name}.normal", times)
        if normal is None:
            continue
        along = (_force(result, f"contact.{name}.tangential_{way}", times) for way in "xy")
        x, y = (np.zeros_like(normal) if one is None else one for one in along)
        found[name] = np.array([x, y, normal])
    return found


def _force(result: PhaseResult, name: str, times: Array) -> Array | None:
    """A force's values: of its curve, or between its nodes; NaN where it is none."""
    curve = _series(result, [name], times, ("forces", "controls"))
    if curve is not None:
        return np.asarray(curve[0])
    group = result.groups.get("forces")
    if group is None or name not in group.values or len(group.time) < 2:
        return None
    values = np.array(group.values[name], dtype=float)
    return np.asarray(np.interp(times, group.time, values))


def _reach(poses: Array, now: Instant) -> Span:
    """From which to which x there is anything, and as much again on both sides."""
    z = now.pose.points(np.array(list(now.parts.spots.values()))).z
    x = np.concatenate([poses[:, 0].ravel(), z.real.ravel(), now.coms.z.real.ravel()])
    x = x[np.isfinite(x)]
    low, high = (float(x.min()), float(x.max())) if len(x) else (0.0, 0.0)
    pad = max(high - low, 1.0)
    return low - pad, high + pad


def _span(values: Array) -> Span:
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
