"""The names that a robot brings along, for expressions: places, forces, energies."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from schemas.expressions.names import MAX_ORDER
from schemas.urdf.robot import Robot

POINT = ("x", "y", "z", "vx", "vy", "vz")
AXES = tuple(f"r{row}{column}" for row in "123" for column in "123")
LINK = (*POINT, "wx", "wy", "wz", *AXES)
COM = (*POINT, "px", "py", "pz", "spin_x", "spin_y", "spin_z")
ENERGY = ("kinetic", "potential", "total")
MOTOR = ("torque", "speed", "power")
CONTACT = ("gap", "slip_x", "slip_y", "normal", "tangential_x", "tangential_y")
FORCES = ("normal", "tangential_x", "tangential_y")

OWN = ("com", "energy", "contact", "motor", "initial", "final")
"""Prefixes that belong to the language: no link may be called so."""

_PLACES = frozenset({"x", "y", "z", "gap", "potential", "norm", "torque", *AXES})


class Bearer(Protocol):
    """What a system says of itself, to be named."""

    @property
    def tree(self) -> Robot:
        """Links and joints."""

    @property
    def contacts(self) -> Mapping[str, object]:
        """By name."""

    @property
    def motor_joints(self) -> Sequence[str]:
        """The joints that are driven."""

    @property
    def balls(self) -> Sequence[str]:
        """The first coordinate of each quaternion."""

    @property
    def coordinates(self) -> Sequence[str]:
        """The coordinates."""

    @property
    def control_names(self) -> Sequence[str]:
        """The controls."""


def names_of(system: Bearer) -> dict[str, int]:
    """Each name that is neither coordinate nor control -> the highest order of its derivatives.

    ``LINK.x`` to ``.vz``, angular velocities ``.wx`` to ``.wz`` in the world's axes, and the
    rotation's entries ``.r11`` to ``.r33`` (columns are the link's axes in the world); places
    of contacts; ``com``, momenta ``com.px`` and ``com.spin_x`` (about the com) and so on;
    ``energy.kinetic``; ``motor.J.torque``; ``contact.C.gap``, its slip and its forces; the norm
    of every quaternion, ``base.norm``; and joints that mimic.
    """
    found = [
        *_of(system.tree.links, LINK),
        *_of(system.contacts, POINT),
        *_of(["com"], COM),
        *_of(["energy"], ENERGY),
        *_of((f"motor.{name}" for name in system.motor_joints), MOTOR),
        *_of((f"contact.{name}" for name in system.contacts), CONTACT),
        *(f"{ball.rpartition('.')[0]}.norm" for ball in system.balls),
        *(joint.name for joint in system.tree.joints if joint.mimic),
    ]
    taken = {*system.coordinates, *system.control_names}
    return {name: _order(name) for name in dict.fromkeys(found) if name not in taken}


def _of(owners: Iterable[str], words: tuple[str, ...]) -> list[str]:
    return [f"{owner}.{word}" for owner in owners for word in words]


def _order(name: str) -> int:
    _, dot, word = name.rpartition(".")
    if word in FORCES:
        return MAX_ORDER - 2
    return MAX_ORDER if not dot or word in _PLACES else MAX_ORDER - 1
