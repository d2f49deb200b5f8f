"""A pair of variables by name, at most one of which may be above zero."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Pair:
    """``0 <= first``, ``0 <= second``, ``first second = 0`` at every step of a phase.

    ``sizes`` are what the two are divided by, in SI units; ``label`` is that of the path row.
    """

    phase: int
    label: str
    first: str
    second: str
    sizes: tuple[float, float] = (1.0, 1.0)
    kind: Literal["gap", "slip", "cone", "limit"] = "gap"
