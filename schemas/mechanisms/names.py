"""The names that a mechanism brings along, for expressions: places, forces, energies."""

from collections.abc import Collection, Iterable
from typing import Protocol

from schemas.expressions.names import MAX_ORDER
from schemas.mechanisms.topology import Link

FRAME = ("x", "y", "angle", "vx", "vy", "omega")
POINT = ("x", "y", "vx", "vy")
COM = ("x", "y", "vx", "vy", "px", "py", "spin")
ENERGY = ("kinetic", "potential", "total")
MOTOR = ("torque", "speed", "power")
SPRING = ("length", "force")
CONTACT = ("gap", "slip", "normal", "tangential")

_VELOCITY = frozenset(
    {
        *("vx", "vy", "omega", "px", "py", "spin", "slip", "speed"),
        *("kinetic", "total", "torque", "power", "force"),
    }
)
_ACCELERATION = frozenset({"normal", "tangential"})


class Parts(Protocol):
    """What of a mechanism has names."""

    @property
    def bodies(self) -> Collection[str]: ...  # noqa: D102
    @property
    def points(self) -> Collection[str]: ...  # noqa: D102
    @property
    def contacts(self) -> Collection[str]: ...  # noqa: D102
    @property
    def motors(self) -> Collection[str]: ...  # noqa: D102
    @property
    def springs(self) -> Collection[str]: ...  # noqa: D102
    @property
    def loops(self) -> Collection[str]: ...  # noqa: D102
    @property
    def touching(self) -> Collection[str]: ...  # noqa: D102
    @property
    def links(self) -> list[Link]: ...  # noqa: D102
    @property
    def coordinates(self) -> list[str]: ...  # noqa: D102
    @property
    def control_names(self) -> list[str]: ...  # noqa: D102


def names_of(mechanism: Parts) -> dict[str, int]:
    """Each name that is neither coordinate nor control -> the highest order of its derivatives.

    ``BODY.x``, ``.y``, ``.angle``, ``.vx``, ``.vy``, ``.omega``; ``POINT.x`` and so on;
    ``com.x`` to ``com.vy``, momenta ``com.px``, ``com.py`` and ``com.spin`` (about the com);
    ``energy.kinetic``, ``.potential``, ``.total``; ``motor.M.torque``, ``.speed``, ``.power``;
    ``spring.S.length``, ``.force``; ``contact.C.gap``, ``.slip``, ``.normal``, ``.tangential``;
    ``loop.L.x``, ``loop.L.y``, its forces; and the joints' own names.
    """
    found = [
        *_of(mechanism.bodies, FRAME),
        *_of(mechanism.points, POINT),
        *_of(mechanism.contacts, POINT),
        *_of(["com"], COM),
        *_of(["energy"], ENERGY),
        *_of([f"motor.{name}" for name in mechanism.motors], MOTOR),
        *_of([f"spring.{name}" for name in mechanism.springs], SPRING),
        *_of([f"contact.{name}" for name in mechanism.touching], CONTACT),
        *_of([f"loop.{name}" for name in mechanism.loops], ("x", "y")),
        *(link.joint_name for link in mechanism.links if len(link.coordinates) == 1),
    ]
    taken = {*mechanism.coordinates, *mechanism.control_names}
    return {name: _order(name) for name in dict.fromkeys(found) if name not in taken}


def _of(owners: Iterable[str], words: tuple[str, ...]) -> list[str]:
    return [f"{owner}.{word}" for owner in owners for word in words]


def _order(name: str) -> int:
    word = name.rpartition(".")[2]
    if word in _ACCELERATION or name.startswith("loop."):
        return MAX_ORDER - 2
    return MAX_ORDER - 1 if word in _VELOCITY else MAX_ORDER
