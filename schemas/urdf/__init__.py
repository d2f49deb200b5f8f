"""Robots as URDF texts: hardened reading, the tree that it makes, and the system over it."""

from schemas.urdf.robot import Joint, Link, Pose, Robot
from schemas.urdf.steps import WORLD, Carriage, Step
from schemas.urdf.system import (
    Mode,
    SpatialContact,
    SpatialForce,
    Urdf,
    contact_forces,
    motor_torque,
)

__all__ = [
    "WORLD",
    "Carriage",
    "Joint",
    "Link",
    "Mode",
    "Pose",
    "Robot",
    "SpatialContact",
    "SpatialForce",
    "Step",
    "Urdf",
    "contact_forces",
    "motor_torque",
]
