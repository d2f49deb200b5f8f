"""Mechanisms as data: bodies, joints, forces and contacts, and what follows from their tree."""

from schemas.mechanisms.contacts import Contact, Mode, Pair, Shape, Surface
from schemas.mechanisms.forces import Force, Losses, Motor, Spring, Torque
from schemas.mechanisms.mechanism import Mechanism, motor_control
from schemas.mechanisms.parts import (
    GROUND,
    Body,
    Floating,
    Joint,
    Loop,
    Place,
    Prismatic,
    Revolute,
    Vector,
    Welded,
)
from schemas.mechanisms.topology import Link

__all__ = [
    "GROUND",
    "Body",
    "Contact",
    "Floating",
    "Force",
    "Joint",
    "Link",
    "Loop",
    "Losses",
    "Mechanism",
    "Mode",
    "Motor",
    "Pair",
    "Place",
    "Prismatic",
    "Revolute",
    "Shape",
    "Spring",
    "Surface",
    "Torque",
    "Vector",
    "Welded",
    "motor_control",
]
