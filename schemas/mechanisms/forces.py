"""What drives a mechanism and what holds it back: motors, springs, forces, torques."""

from typing import Literal, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from schemas.base import Identifier, Posted
from schemas.expressions import Expression
from schemas.mechanisms.parts import ONE, ZERO, Place, Vector
from schemas.values import Bound


class Losses(Posted):
    """The motor model of 003, equations 2.1 and 2.2; the control is then the current I in A.

    ``T = Km I - C1 w - (C0 + mu Km abs(I)) sign(w)``, ``P = (I R + sign(w) Vc + Km w) I``, with
    w the speed of the output shaft. Signs are smoothed by ``tanh(w / smoothing)``.
    """

    constant: Expression = Field(description="Km, N m / A, with the gearbox.")
    coulomb: Expression = Field(default=ZERO, description="C0, N m.")
    viscous: Expression = Field(default=ZERO, description="C1, N m s.")
    friction: Expression = Field(default=ZERO, description="mu, of the gearbox under load.")
    resistance: Expression = Field(default=ZERO, description="R, ohm.")
    brush: Expression = Field(default=ZERO, description="Vc, V.")
    smoothing: Expression = Field(default=Expression.read(0.01), description="rad/s, m/s.")


class Motor(Posted):
    """Drives a joint. Its control is ``motor.NAME.torque`` (a force, N, of a slider).

    With ``gear`` the joint sees the control times the gear. With ``losses`` the control is
    ``motor.NAME.current`` and ``motor.NAME.torque`` is what reaches the joint; the gearbox is then
    in their constants. Limits are of the joint's side: torque, ``speed``, ``power``.
    """

    joint: Identifier
    torque: Bound | None = None
    speed: Bound | None = None
    power: Bound | None = None
    current: Bound | None = None
    gear: Expression = ONE
    losses: Losses | None = None


class Spring(Posted):
    """Between parent and child of a joint, or between two points.

    The force is ``stiffness (rest - z) - damping d(z)`` along z, the joint's coordinate or the
    distance of the points: a positive one pushes them apart. A tendon pulls only: its force is
    the smaller of that and 0. ``engaged`` scales the whole: 1, a schedule over ``t``, or a static
    that the solver chooses between 0 and 1 (a clutch).
    """

    joint: Identifier | None = None
    between: list[Place] | None = Field(default=None, min_length=2, max_length=2)
    stiffness: Expression = ZERO
    rest: Expression = ZERO
    damping: Expression = ZERO
    pulling_only: bool = False
    engaged: Expression = ONE

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.joint is None) == (self.between is None):
            raise PydanticCustomError("one_spring", "give either 'joint' or 'between'")
        return self


class Force(Posted):
    """A force at a point of a body, N: ``value`` along ``direction``, in the body or the world."""

    body: Identifier
    at: Vector
    direction: Vector
    value: Expression = Field(description="Over coordinates, velocities, controls, time.")
    frame: Literal["body", "world"] = "body"


class Torque(Posted):
    """A torque at a joint, from parent to child, N m (N of a slider); or on a body alone."""

    joint: Identifier | None = None
    body: Identifier | None = None
    value: Expression = Field(description="Over coordinates, velocities, controls, time.")

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.joint is None) == (self.body is None):
            raise PydanticCustomError("one_torque", "give either 'joint' or 'body'")
        return self
