"""A planar mechanism as data: bodies, joints, what drives it, what it may touch."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, Literal, Self

from pydantic import Field

from schemas.base import Identifier, Posted, Series
from schemas.expressions import Expression, derivative
from schemas.expressions.names import MAX_ORDER
from schemas.limits import MODEL_LIMITS
from schemas.mechanisms.contacts import Contact, Mode, Pair, Shape, Surface
from schemas.mechanisms.forces import Force, Motor, Spring, Torque
from schemas.mechanisms.names import names_of
from schemas.mechanisms.parts import GROUND, Body, Joint, Loop, Place, Vector
from schemas.mechanisms.topology import Link, links
from schemas.pointers import Part
from schemas.values import Scalar

_CONSTANT = (
    *("gravity", "bodies", "joints", "loops", "points", "motors", "springs"),
    *("forces", "torques", "contacts", "surfaces", "shapes", "pairs"),
)
_CACHED = ("links", "coordinates", "control_names", "touching", "defined")
_VARYING = frozenset({("springs", "engaged"), ("forces", "value"), ("torques", "value")})


def _gravity() -> list[Expression]:
    return [Expression.read(0), Expression.read(-9.81)]


def _level() -> dict[str, Surface]:
    return {GROUND: Surface()}


class Mechanism(Posted):
    """Rigid bodies in a vertical plane.

    Coordinates are those of the joints; with ``angles: absolute`` a hinge's is the angle of its
    child to the world, ``BODY.angle``, and the joint's own name remains known. Velocities are
    ``d(q)`` (of dotted names ``BODY.d(x)``).

    ``mode`` says which contacts touch all along the phase, and how; loops always hold.
    """

    kind: Literal["mechanism"]
    parameters: dict[Identifier, Scalar] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.parameters
    )
    gravity: Vector = Field(default_factory=_gravity, description="m/s^2, in the world's frame.")
    angles: Literal["relative", "absolute"] = "relative"
    bodies: dict[Identifier, Body] = Field(min_length=1, max_length=MODEL_LIMITS.bodies)
    joints: dict[Identifier, Joint] = Field(min_length=1, max_length=MODEL_LIMITS.bodies)
    loops: dict[Identifier, Loop] = Field(default_factory=dict, max_length=MODEL_LIMITS.bodies)
    points: dict[Identifier, Place] = Field(
        default_factory=dict,
        max_length=MODEL_LIMITS.contacts,
        description="Places with a name: NAME.x, NAME.y and their velocities NAME.vx, NAME.vy.",
    )
    motors: dict[Identifier, Motor] = Field(default_factory=dict, max_length=MODEL_LIMITS.bodies)
    springs: dict[Identifier, Spring] = Field(default_factory=dict, max_length=MODEL_LIMITS.bodies)
    controls: list[Identifier] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.controls,
        description="Controls of your own, for 'forces' and 'torques'.",
    )
    define: dict[Identifier, Expression] = Field(default_factory=dict)
    forces: dict[Identifier, Force] = Field(default_factory=dict, max_length=MODEL_LIMITS.bodies)
    torques: dict[Identifier, Torque] = Field(default_factory=dict, max_length=MODEL_LIMITS.bodies)
    contacts: dict[Identifier, Contact] = Field(
        default_factory=dict, max_length=MODEL_LIMITS.contacts
    )
    surfaces: dict[Identifier, Surface] = Field(
        default_factory=_level, max_length=MODEL_LIMITS.contacts
    )
    shapes: dict[Identifier, Shape] = Field(default_factory=dict, max_length=MODEL_LIMITS.contacts)
    pairs: dict[Identifier, Pair] | None = Field(
        default=None,
        max_length=MODEL_LIMITS.contacts,
        description="What may touch what; left out: every contact may touch every surface.",
    )
    mode: dict[Identifier, Mode] = Field(
        default_factory=dict, description="Pair -> what it does; pairs left out do not touch."
    )
    loose: list[Series] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.contacts,
        description="Forces that the motion does not determine, controls then: the solver's own "
        "finding, such as contact.heel.tangential where contact.toe.tangential is found already.",
    )

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but nothing that follows from the old fields is kept."""
        copied = super().model_copy(update=update, deep=deep)
        for name in _CACHED:
            copied.__dict__.pop(name, None)
        return copied

    @cached_property
    def links(self) -> list[Link]:
        """Bodies and their joints, parents first."""
        return links(self.joints, absolute=self.angles == "absolute")

    @cached_property
    def coordinates(self) -> list[str]:
        """The coordinates q."""
        return [name for link in self.links for name in link.coordinates]

    @property
    def state_names(self) -> list[str]:
        """Coordinates, then velocities."""
        return [*self.coordinates, *(derivative(name) for name in self.coordinates)]

    @cached_property
    def control_names(self) -> list[str]:
        """The motors' controls, those of the user, and forces that are loose."""
        motors = (motor_control(name, one) for name, one in self.motors.items())
        return [*motors, *self.controls, *self.loose]

    @cached_property
    def touching(self) -> dict[str, Pair]:
        """Every permitted pair by its name."""
        if self.pairs is not None:
            return dict(self.pairs)
        alone = len(self.surfaces) == 1
        return {
            contact if alone else f"{contact}_{surface}": Pair(contact=contact, against=surface)
            for contact in self.contacts
            for surface in self.surfaces
        }

    @cached_property
    def defined(self) -> dict[str, int]:
        """Names that the mechanism defines of itself -> the highest order of their derivatives."""
        return names_of(self)

    @property
    def positions(self) -> set[str]:
        """The names that a pose decides: coordinates, places, angles, gaps, lengths."""
        decided = {name for name, order in self.defined.items() if order == MAX_ORDER}
        return {*self.coordinates, *decided}

    def constants(self) -> Iterator[tuple[tuple[Part, ...], Expression]]:
        """Everything that does not change over time: masses, places, stiffnesses; and heights."""
        for field in _CONSTANT:
            yield from _expressions(getattr(self, field), (field,))

    def equations(self) -> Iterator[tuple[tuple[Part, ...], str, Expression]]:
        """What the user wrote into the dynamics."""
        for name, force in self.forces.items():
            yield ("forces", name, "value"), f"force {name}", force.value
        for name, torque in self.torques.items():
            yield ("torques", name, "value"), f"torque {name}", torque.value
        for name, spring in self.springs.items():
            yield ("springs", name, "engaged"), f"spring {name}", spring.engaged


def motor_control(name: str, motor: Motor) -> Series:
    """The name of a motor's control."""
    return f"motor.{name}.{'torque' if motor.losses is None else 'current'}"


def _expressions(
    value: object, parts: tuple[Part, ...]
) -> Iterator[tuple[tuple[Part, ...], Expression]]:
    """The constant expressions in any part of a mechanism, each with its place."""
    if isinstance(value, Expression):
        if (parts[0], parts[-1]) not in _VARYING:
            yield parts, value
    elif isinstance(value, Posted):
        for field in type(value).model_fields:
            yield from _expressions(getattr(value, field), (*parts, field))
    elif isinstance(value, dict):
        for name, one in value.items():
            yield from _expressions(one, (*parts, name))
    elif isinstance(value, list):
        for index, one in enumerate(value):
            yield from _expressions(one, (*parts, index))
