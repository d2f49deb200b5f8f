"""Guesses: from where a solve starts; one model a kind."""

from typing import Annotated, Literal

from pydantic import FailFast, Field, StringConstraints

from schemas.base import AlsoNamed, Posted, Series
from schemas.results import CurveGroup
from schemas.values import Bound, Scalar

Duration = Annotated[float, Field(gt=0, le=1e9, description="The guessed length in seconds.")]


PartName = Annotated[
    str,
    StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,63}(?:/[A-Za-z0-9_]{1,64}){0,2}$"),
]
"""The name of a result's phase: PHASE, or PHASE/MODE."""

StaticName = Annotated[
    str, StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_./]{0,255}$", max_length=256)
]
"""The name of a result's static: the user's, or that of an impulse."""


class LinearGuess(Posted):
    """Straight lines between the initial and the final values; open ends take the other end."""

    kind: Literal["linear"] = "linear"
    duration: Duration | None = None


class ConstantGuess(Posted):
    """The same value all along; names left out take the linear guess."""

    kind: Literal["constant"]
    duration: Duration | None = None
    values: dict[Series, Scalar]


class PointsGuess(Posted):
    """Values at given times, straight lines between; names left out take the linear guess.

    ``time`` increases; it is stretched onto the guessed span of the phase, of which ``duration``
    is the length where that is given.
    """

    kind: Literal["points"]
    duration: Duration | None = None
    time: Annotated[list[float], FailFast()] = Field(min_length=2, max_length=10_000)
    values: dict[Series, Annotated[list[Scalar], FailFast()]]


Corner = Annotated[
    list[Scalar | None],
    Field(min_length=2, max_length=2, description="x and y in the world, m; null is open."),
]


class KeyPose(Posted):
    """Where parts of a mechanism are at one time of a guess.

    ``places`` are of points, contacts, bodies (their origins) and ``com``; ``values`` are of
    coordinates and of all else that a pose decides, such as ``knee``, ``trunk.angle`` or
    ``contact.toe.gap``; a pair bounds the value. The rest stays near the pose before.
    """

    at: float
    places: dict[Series, Corner] = Field(default_factory=dict, max_length=64)
    values: dict[Series, Bound] = Field(default_factory=dict, max_length=200)


class PosesGuess(Posted):
    """Key poses of planar mechanisms, by inverse kinematics; coordinates go straight between them.

    A pose keeps to bounds and joint limits, closes loops, and is inside of nothing that it may
    touch; the first and the last also keep to what the phase says of its ends. Where one is out of
    reach, the closest one is taken, and a warning says how far off it is. Velocities are those of
    the straight lines, controls take the linear guess. Times increase and are stretched as those of
    ``points`` are.
    """

    kind: Literal["poses"]
    duration: Duration | None = None
    poses: Annotated[list[KeyPose], FailFast()] = Field(min_length=2, max_length=200)


class RandomGuess(Posted):
    """Another guess plus smooth noise within the bounds, the same for the same seed.

    ``spread`` is the noise's size relative to the width of the bounds, or to the typical size
    where a side is open. ``about`` is what the noise is added to: the linear guess unless given.
    """

    kind: Literal["random"]
    duration: Duration | None = None
    seed: int = Field(default=0, ge=0, le=2**31)
    spread: float = Field(default=0.25, gt=0, le=10)
    about: (
        Annotated[
            LinearGuess | ConstantGuess | PointsGuess | PosesGuess, Field(discriminator="kind")
        ]
        | None
    ) = None


class SolutionPhase(Posted):
    """A phase of an earlier result: its name and its curves, as a result has them."""

    name: PartName
    curves: dict[str, CurveGroup]


class SolutionGuess(Posted):
    """An earlier result, from any method and mesh; what it leaves out takes the linear guess.

    Phases are matched by name; the only phase of each takes the other's.
    """

    kind: Literal["solution"]
    phases: list[SolutionPhase] = Field(min_length=1, max_length=64)
    static: dict[StaticName, float] = Field(default_factory=dict)


Guess = Annotated[
    LinearGuess | ConstantGuess | PointsGuess | PosesGuess | RandomGuess | SolutionGuess,
    Field(discriminator="kind"),
    AlsoNamed((("from_job", "string"),), "The solution of an own, finished job, by its id."),
]
