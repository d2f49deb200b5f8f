"""A quantity over a step, and what is asked of the arithmetic that makes one of others."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from solver.expressions import SX

CONSTANT = -1

Column = SX | Sequence[SX]
"""One entry a coordinate."""


@dataclass(frozen=True, slots=True)
class Chord:
    """A quantity over a step, all scalars.

    Attributes
    ----------
    before, after, mean
        Its values at both ends, and half their sum.
    rate
        Its change over the time of the step, where that of coordinates is their velocity.
    place
        Its number among all; negative where it does not change.
    """

    before: SX
    after: SX
    mean: SX
    rate: SX
    place: int = CONSTANT

    @property
    def varies(self) -> bool:
        """Whether it depends on the coordinates."""
        return self.place != CONSTANT


Part = tuple[Chord, SX]
"""What a quantity is made of, and the factor of its change."""


class Arithmetic(Protocol):
    """Makes quantities of others (``solver.discrete.slopes``)."""

    def constant(self, value: SX) -> Chord: ...  # noqa: D102
    def made(  # noqa: D102
        self, before: SX, after: SX, parts: Sequence[Part], mean: SX | None = None
    ) -> Chord: ...
    def turn(self, angle: Chord) -> tuple[Chord, Chord]: ...  # noqa: D102
