"""A robot in three dimensions as data: a URDF text, its base, motors, forces and contacts."""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted, Series
from schemas.expressions import Expression, derivative
from schemas.limits import MODEL_LIMITS
from schemas.pointers import Part
from schemas.suggest import did_you_mean
from schemas.urdf.names import FORCES, OWN, names_of
from schemas.urdf.robot import Joint, Robot
from schemas.urdf.steps import BASE, Base, Carriage, carriages, coordinates
from schemas.urdf.text import UrdfText
from schemas.values import Scalar

Vector3 = Annotated[
    list[Expression],
    Field(min_length=3, max_length=3, description="x, y and z, constant: parameters, statics."),
]
Mode = Literal["sticking", "sticking_x", "sticking_y", "frictionless"]
"""What a touching contact does: ``sticking_x`` holds along x, and slides freely along y."""

_ZERO = Expression.read(0)
_NORMALS = 3
"""Points of one rigid body that the ground can press apart from each other."""


def _origin() -> list[Expression]:
    return [_ZERO, _ZERO, _ZERO]


def _gravity() -> list[Expression]:
    return [_ZERO, _ZERO, Expression.read(-9.81)]


class SpatialContact(Posted):
    """A point of a link, in its frame, that may touch the ground; or a sphere about it."""

    link: Identifier
    at: Vector3 = Field(default_factory=_origin)
    radius: Expression = Field(default=_ZERO, description="Of a sphere, m.")


class SpatialForce(Posted):
    """A force at a point of a link, N: ``value`` along ``direction``, its axes or the world's."""

    link: Identifier
    at: Vector3 = Field(default_factory=_origin)
    direction: Vector3
    value: Expression = Field(description="Over coordinates, velocities, controls, time.")
    frame: Literal["link", "world"] = "link"


class Ground(Posted):
    """Level ground at a height; z points up."""

    height: Expression = _ZERO
    friction: Expression = Field(default=Expression.read(1))


class Urdf(Posted):
    """Rigid links of a URDF text.

    Coordinates are those of the joints, by their names, after those of the base: ``base.x``,
    ``base.y``, ``base.z`` and the quaternion ``base.qw`` to ``base.qz`` (from the root link's axes
    to the world's) of a floating one; ``base.x``, ``base.z`` and ``base.pitch`` about y of a planar
    one. Velocities are ``d(q)``, of dotted names ``base.d(x)``: rates of the coordinates, no
    angular velocities.

    The motion depends on the direction of a quaternion only, not on its norm; the norm is held at
    1 by its own equation, and ``base.norm`` tells.

    ``mode`` says which contacts touch all along the phase.
    """

    kind: Literal["urdf"]
    text: UrdfText
    base: Base = "fixed"
    gravity: Vector3 = Field(default_factory=_gravity, description="m/s^2, in the world's frame.")
    parameters: dict[Identifier, Scalar] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.parameters
    )
    motors: list[Identifier] | None = Field(
        default=None,
        max_length=MODEL_LIMITS.controls,
        description="Joints that are driven, by motor.NAME.torque; left out: all that can be.",
    )
    limits: bool = Field(default=True, description="Whether the text's joint limits hold.")
    controls: list[Identifier] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.controls,
        description="Controls of your own, for 'forces'.",
    )
    define: dict[Identifier, Expression] = Field(default_factory=dict)
    forces: dict[Identifier, SpatialForce] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.bodies
    )
    contacts: dict[Identifier, SpatialContact] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.contacts
    )
    ground: Ground = Ground()
    mode: dict[Identifier, Mode] = Field(
        default_factory=dict, description="Contact -> what it does; those left out do not touch."
    )

    @property
    def tree(self) -> Robot:
        """Links and joints of the text."""
        return self.text.robot

    @cached_property
    def carriages(self) -> list[Carriage]:
        """Links and how they hang on each other, parents first."""
        return carriages(self.tree, self.base)

    @cached_property
    def coordinates(self) -> list[str]:
        """The coordinates q."""
        return coordinates(self.carriages)

    @cached_property
    def balls(self) -> list[str]:
        """The first coordinate of each quaternion."""
        steps = [step for one in self.carriages for step in one.steps]
        return [step.coordinates[0] for step in steps if step.kind == "ball"]

    @property
    def state_names(self) -> list[str]:
        """Coordinates, then velocities."""
        return [*self.coordinates, *(derivative(name) for name in self.coordinates)]

    @cached_property
    def motor_joints(self) -> list[str]:
        """The joints that are driven."""
        if self.motors is not None:
            return list(self.motors)
        return [joint.name for joint in self.tree.moving if _drivable(joint)]

    @cached_property
    def control_names(self) -> list[str]:
        """The motors' torques (forces of sliders), then the user's own."""
        return [*(motor_torque(name) for name in self.motor_joints), *self.controls]

    @cached_property
    def defined(self) -> dict[str, int]:
        """Names that the robot defines of itself -> the highest order of their derivatives."""
        return names_of(self)

    @cached_property
    def touching(self) -> dict[str, SpatialContact]:
        """Every contact that may touch, by its name."""
        return dict(self.contacts)

    @cached_property
    def intervals(self) -> dict[Series, tuple[float, float]]:
        """The text's limits: series -> lower and upper one."""
        if not self.limits:
            return {}
        found: dict[Series, tuple[float, float]] = {}
        for joint in self.tree.moving:
            if _drivable(joint):
                found |= _intervals(joint)
        known = {*self.state_names, *self.control_names}
        return {name: pair for name, pair in found.items() if name in known}

    def constants(self) -> Iterator[tuple[tuple[Part, ...], Expression]]:
        """Everything that does not change over time."""
        for index, one in enumerate(self.gravity):
            yield ("gravity", index), one
        for field in ("contacts", "forces"):
            for name, one in getattr(self, field).items():
                for word in ("at", "direction"):
                    for index, entry in enumerate(getattr(one, word, ())):
                        yield (field, name, word, index), entry
        for name, contact in self.contacts.items():
            yield ("contacts", name, "radius"), contact.radius
        for word in ("height", "friction"):
            yield ("ground", word), getattr(self.ground, word)

    def equations(self) -> Iterator[tuple[tuple[Part, ...], str, Expression]]:
        """What the user wrote into the dynamics."""
        for name, force in self.forces.items():
            yield ("forces", name, "value"), f"force {name}", force.value

    @model_validator(mode="after")
    def _fits(self) -> Self:
        """What the fields name is there, once; nothing takes a name that has a meaning."""
        self._names_free()
        drivable = [joint.name for joint in self.tree.moving if _drivable(joint)]
        for index, name in enumerate(self.motors or []):
            kind = "a hinge or slider that mimics nobody"
            _among(f"the motor '{name}'", name, drivable, kind, ("motors", index))
        if len(set(self.motor_joints)) < len(self.motor_joints):
            _refuse("a joint named twice in 'motors'", "name each once")
        self._parts_known()
        self._held_once()
        if not self.coordinates:
            mend = "make a joint revolute, or the base floating"
            _refuse("nothing moves: every joint is fixed, and so is the base", mend)
        if len(self.state_names) > MODEL_LIMITS.states:
            count, most = len(self.state_names), MODEL_LIMITS.states
            _refuse(
                f"over the limit: {count} states, at most {most}", "fix joints that matter less"
            )
        return self

    def _parts_known(self) -> None:
        links = list(self.tree.links)
        for field, what in (("contacts", self.contacts), ("forces", self.forces)):
            for name, one in what.items():
                told = f"the link of '{name}'"
                _among(told, one.link, links, "a link", (field, name, "link"))
        for name in self.mode:
            told = f"'{name}' in 'mode'"
            if name not in self.contacts:
                hint = did_you_mean(name, self.contacts)
                _refuse(f"{told} is not a contact of the system", hint, ("mode", name))

    def _names_free(self) -> None:
        links = self.tree.links
        for name in (*OWN, *(f"{n}" for n in self.contacts)):
            if name in links:
                _refuse(f"'{name}' is the name of a link", "rename the link or the contact")
        if self.base != "fixed" and BASE in links and self.tree.root != BASE:
            mend = "rename it, or take away what carries it"
            _refuse(f"'{BASE}' is a link that is not the root, and the name of the base", mend)

    def _held_once(self) -> None:
        """Contacts of one rigid body hold what the others leave free."""
        body: dict[str, str] = {}
        for one in self.carriages:
            body[one.link] = one.link if one.steps else body.get(one.parent, "")
        for rigid in dict.fromkeys(body.values()):
            own = [name for name in self.mode if body[self.contacts[name].link] == rigid]
            if own and not rigid:
                _refuse(f"'{own[0]}' in 'mode' does not move", "take it away")
            sticking = [name for name in own if self.mode[name] == "sticking"]
            if len(sticking) > 1 or len(own) > _NORMALS:
                mend = "let one stick, and up to two more be frictionless"
                what = "' and '".join((sticking if len(sticking) > 1 else own)[:2])
                _refuse(f"'{what}' hold the same of one rigid body twice", mend)


def motor_torque(joint: str) -> Series:
    """The name of a motor's control."""
    return f"motor.{joint}.torque"


def contact_forces(name: str, mode: Mode | Literal["split"]) -> tuple[str, ...]:
    """The forces on a link at a contact that touches: along z, then where it sticks.

    All of a ``split`` one are given elsewhere (``solver.contact``).
    """
    held = {
        "split": "xy",
        "sticking": "xy",
        "sticking_x": "x",
        "sticking_y": "y",
        "frictionless": "",
    }[mode]
    return tuple(f"contact.{name}.{word}" for word in FORCES if word[-1] in (*held, "l"))


def _drivable(joint: Joint) -> bool:
    return joint.kind not in ("floating", "planar") and joint.mimic is None


def _intervals(joint: Joint) -> dict[Series, tuple[float, float]]:
    limits, found = joint.limits, dict[Series, tuple[float, float]]()
    if limits.lower is not None or limits.upper is not None:
        lower = -math.inf if limits.lower is None else limits.lower
        found[joint.name] = lower, math.inf if limits.upper is None else limits.upper
    for name, size in (
        (derivative(joint.name), limits.velocity),
        (motor_torque(joint.name), limits.effort),
    ):
        if size is not None:
            found[name] = -size, size
    return found


def _among(what: str, name: str, options: list[str], kind: str, at: tuple[Part, ...]) -> None:
    if name not in options:
        _refuse(f"{what} is not {kind} of the text", did_you_mean(name, options), at)


def _refuse(message: str, hint: str, at: tuple[Part, ...] = ()) -> None:
    """Raise it for the part that stands ``at`` a place of the system."""
    context = {"message": message, "hint": hint, "at": at}
    raise PydanticCustomError("urdf", "{message}", context)
