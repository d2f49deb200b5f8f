"""What of a mechanism is hardly meant: angles in degrees, motors that share a joint."""

import math
from collections.abc import Iterator, Mapping

from schemas import resolve
from schemas.expressions import ExpressionError
from schemas.mechanisms import Floating, Mechanism, Revolute
from schemas.pointers import Part, pointer
from schemas.systems import System
from schemas.values import Bound, Scalar

_TURNS = 4 * math.pi
"""Rad; larger angles than those of two turns are rare, and common in degrees."""

Ends = Mapping[str, Mapping[str, Bound]]
"""Bounds by the field that they stand in, then by name."""


def suspicions(system: System, ends: Ends, place: tuple[Part, ...]) -> Iterator[str]:
    """One line for each, with its place; the system's fields stand at ``place`` + ``system``.

    Parameters
    ----------
    ends
        What bounds coordinates: of a phase ``bounds``, ``initial``, ``final``.
    """
    if not isinstance(system, Mechanism):
        return
    known = _parameters(system)
    for name, joint in system.joints.items():
        if isinstance(joint, Revolute) and joint.limits is not None:
            yield from _degrees(joint.limits, known, (*place, "system", "joints", name, "limits"))
    angles = set(_angles(system))
    for field, bounds in ends.items():
        for name, bound in bounds.items():
            if name in angles:
                yield from _degrees(bound, known, (*place, field, name))
    yield from _shared(system, (*place, "system", "motors"))


def _degrees(bound: Bound, known: Mapping[str, float], place: tuple[Part, ...]) -> Iterator[str]:
    sides = [side for side in (bound.lower, bound.upper) if side is not None]
    largest = max((abs(_value(side, known)) for side in sides), default=0.0)
    if largest > _TURNS:
        yield (
            f"{pointer(*place)}: an angle of {largest:.4g} rad is more than two turns and looks "
            "like degrees: write 90*pi/180 for 90 degrees"
        )


def _value(side: Scalar, known: Mapping[str, float]) -> float:
    try:
        return resolve.scalar(side, known)
    except ExpressionError:  # over a static, which is free
        return 0.0


def _parameters(system: Mechanism) -> dict[str, float]:
    known: dict[str, float] = {}
    for name, value in system.parameters.items():
        known[name] = _value(value, known)
    return known


def _angles(system: Mechanism) -> Iterator[str]:
    """Coordinates, and the bodies' own angles, in rad."""
    for link in system.links:
        yield f"{link.body}.angle"
        if isinstance(link.joint, Revolute):
            yield link.joint_name
        elif isinstance(link.joint, Floating):
            yield link.coordinates[-1]


def _shared(system: Mechanism, place: tuple[Part, ...]) -> Iterator[str]:
    first: dict[str, str] = {}
    for name, motor in system.motors.items():
        if motor.joint in first:
            yield (
                f"{pointer(*place, name, 'joint')}: '{first[motor.joint]}' drives the joint "
                f"'{motor.joint}' already; their torques add up"
            )
        first.setdefault(motor.joint, name)
