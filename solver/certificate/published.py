"""What the result of a contact-implicit phase says, as arrays."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.expressions import derivative
from schemas.mechanisms import Mechanism, Prismatic, Revolute
from schemas.methods import ContactImplicit
from schemas.results import Group, PhaseResult
from schemas.urdf import Urdf
from schemas.urdf.names import FORCES
from solver.numeric import Array, MalformedCurves

_OF_PAIRS = ("normal", "tangential")


@dataclass(frozen=True, slots=True)
class Published:
    """What a result says, as arrays. Forces belong to the step that ends at their time.

    Attributes
    ----------
    knots
        Their times, (N + 1,), s.
    q, v
        Coordinates and velocities at the knots, (n, N + 1).
    u
        Controls, (controls, N).
    forces
        By name, N or N m, (N,).
    """

    knots: Array
    q: Array
    v: Array
    u: Array
    forces: Mapping[str, Array]

    @classmethod
    def read(
        cls, system: Mechanism | Urdf, method: ContactImplicit, result: PhaseResult
    ) -> "Published":
        """Raises MalformedCurves where a series is missing or has another length."""
        knots = np.array(result.knots, dtype=float)
        if len(knots) < 2 or not np.all(np.diff(knots) > 0):
            raise MalformedCurves(f"the knots of phase {result.name} do not increase")
        forces = force_names(system, method)
        own, ends = system.coordinates, (len(knots), len(knots) - 1)
        states, controls, rows = (
            _series(result, group, names, count)
            for group, names, count in (
                ("states", [*own, *(derivative(name) for name in own)], ends[0]),
                ("controls", system.control_names, ends[1]),
                ("forces", forces, ends[1]),
            )
        )
        q, v = np.split(states, 2)
        return cls(knots, q, v, controls, dict(zip(forces, rows, strict=True)))


def force_names(mechanism: Mechanism | Urdf, method: ContactImplicit) -> list[str]:
    """The series of contacts, stops and loops that contact-implicit steps publish."""
    words = _OF_PAIRS if isinstance(mechanism, Mechanism) else FORCES
    found = [f"contact.{pair}.{word}" for pair in mechanism.touching for word in words]
    found += [f"limit.{joint}" for joint in stops(mechanism)] if method.stops else []
    if isinstance(mechanism, Urdf):
        return found
    return found + [f"loop.{loop}.{word}" for loop in mechanism.loops for word in ("x", "y")]


def stops(mechanism: Mechanism | Urdf) -> list[str]:
    """The joints that have limits."""
    if isinstance(mechanism, Urdf):
        return [name for name in mechanism.intervals if name in mechanism.coordinates]
    return [
        name
        for name, joint in mechanism.joints.items()
        if isinstance(joint, Revolute | Prismatic) and joint.limits is not None
    ]


def _series(result: PhaseResult, label: str, names: Sequence[str], count: int) -> Array:
    """Series of a group, (names, count); numbers that do not exist are NaN."""
    group = result.groups.get(label, Group(time=[], values={}))
    for name in names:
        if len(group.values.get(name, [])) != count:
            raise MalformedCurves(f"phase {result.name} has no {count} values of {name}")
    rows = [[np.nan if x is None else x for x in group.values[name]] for name in names]
    return np.array(rows, dtype=float).reshape(len(names), count)


@dataclass(frozen=True, slots=True)
class Stops:
    """Limits as ``slopes @ q + offsets >= 0``: (rows, n), (rows,); ``efforts`` (rows, N) >= 0."""

    names: tuple[str, ...]
    slopes: Array
    offsets: Array
    efforts: Array


def stops_of(
    joints: Iterable[tuple[str, Array, float, tuple[float, float]]], published: Published
) -> Stops:
    """Of joints: name, slope (n,) and offset of its value over q, and lower and upper limit."""
    names, slopes, offsets, efforts = [], [], [], []
    for joint, row, offset, limits in joints:
        effort = published.forces[f"limit.{joint}"]
        for sign, limit in zip((1.0, -1.0), limits, strict=True):
            names.append(f"{joint} {'lower' if sign > 0 else 'upper'} limit")
            slopes.append(sign * row)
            offsets.append(sign * (offset - limit))
            efforts.append(np.maximum(sign * effort, 0.0))
    count, n = len(names), len(published.q)
    return Stops(
        tuple(names),
        np.reshape(slopes, (count, n)),
        np.array(offsets),
        np.reshape(efforts, (count, len(published.knots) - 1)),
    )
