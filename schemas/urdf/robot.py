"""A robot as its URDF text gives it: links, and joints from parent to child; numbers only."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from schemas.urdf.algebra import IDENTITY, NOTHING, ZERO, Matrix, Vector

HINGES = ("revolute", "continuous")
MOVING = (*HINGES, "prismatic", "floating", "planar")


class Pose(NamedTuple):
    """A frame in another: where its origin is, in m, and the matrix of its axes as columns."""

    origin: Vector = ZERO
    axes: Matrix = IDENTITY


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body, in its own frame.

    ``inertia`` is about the centre of mass, in the link's axes, kg m^2; ``mass`` in kg.
    """

    name: str
    mass: float = 0.0
    com: Vector = ZERO
    inertia: Matrix = NOTHING
    line: int = 1


@dataclass(frozen=True, slots=True)
class Limits:
    """Of a joint's coordinate (rad, m), speed and effort; None where the text gives none."""

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None


class Mimic(NamedTuple):
    """A joint that follows another one: ``multiplier * q + offset``."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Joint:
    """How ``child`` moves in ``parent``.

    ``pose`` is that of the joint's frame in the parent's, which is the child's frame where the
    coordinate is zero; ``axis`` is a unit vector in it. ``damping`` in N m s/rad, N s/m.
    """

    name: str
    kind: str
    parent: str
    child: str
    pose: Pose = field(default_factory=Pose)
    axis: Vector = (1.0, 0.0, 0.0)
    limits: Limits = Limits()
    damping: float = 0.0
    mimic: Mimic | None = None
    line: int = 1


@dataclass(frozen=True, slots=True)
class Robot:
    """All links and joints; ``joints`` come in an order in which parents are reached first.

    Names are fit for expressions: what may not stand in one is ``_`` (``left-foot`` is
    ``left_foot``). ``remarks`` say what of the text was left aside.
    """

    name: str
    root: str
    links: Mapping[str, Link]
    joints: tuple[Joint, ...]
    remarks: tuple[str, ...] = ()

    @property
    def moving(self) -> list[Joint]:
        """The joints that are not fixed."""
        return [joint for joint in self.joints if joint.kind != "fixed"]
