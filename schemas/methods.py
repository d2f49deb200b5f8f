"""The transcription methods a problem may ask for; one model a method, told apart by ``kind``."""

from typing import Annotated, Literal

from pydantic import Field

from schemas.base import Posted
from schemas.limits import MODEL_LIMITS

Segments = Annotated[
    int, Field(ge=1, le=MODEL_LIMITS.segments // 4, description="Segments of the first mesh.")
]


class Trapezoidal(Posted):
    """Trapezoidal collocation: control piecewise linear, state piecewise quadratic, order 2."""

    kind: Literal["trapezoidal"]
    segments: Segments = 50


class HermiteSimpson(Posted):
    """Hermite-Simpson collocation: state piecewise cubic, order 4.

    ``separated`` keeps the midpoint states as variables (better on few segments),
    ``compressed`` eliminates them (better on many). A ``linear`` control does not overshoot
    between nodes where a bound is active; a ``quadratic`` one is more accurate where it is smooth.
    """

    kind: Literal["hermite_simpson"]
    segments: Segments = 25
    form: Literal["separated", "compressed"] = "separated"
    control: Literal["quadratic", "linear"] = "quadratic"


Method = Annotated[Trapezoidal | HermiteSimpson, Field(discriminator="kind")]
METHODS: tuple[type[Posted], ...] = (Trapezoidal, HermiteSimpson)
