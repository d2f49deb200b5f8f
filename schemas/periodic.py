"""Periodic motions: the end of a phase is its start, after renaming and perhaps an impact."""

from typing import Annotated

from pydantic import Field

from schemas.base import Identifier, Posted, Series
from schemas.limits import MODEL_LIMITS

Swapped = Annotated[list[Identifier], Field(min_length=2, max_length=2)]


class Impact(Posted):
    """The impact at the end of a phase; contacts are called as they are before it.

    Contacts that touch afterwards stick, or slide where the first mode of a sequence says so.
    """

    lands: list[Identifier] = Field(
        min_length=1, max_length=MODEL_LIMITS.contacts, description="Contacts that begin to touch."
    )
    leaves: list[Identifier] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.contacts,
        description="Contacts that let go: they move off the ground afterwards.",
    )


class Periodic(Posted):
    """The phase starts as it ends: ``initial.x = final.y``, where ``swap`` makes y of x.

    A swap exchanges names of bodies, joints, contacts and states wherever they stand:
    ``["left_leg", "right_leg"]`` exchanges ``left_leg.angle`` and ``right_leg.angle``.
    """

    swap: list[Swapped] = Field(default_factory=list, max_length=MODEL_LIMITS.states)
    free: list[Series] = Field(
        default_factory=list,
        max_length=MODEL_LIMITS.states,
        description="States that go on: base.x of a walker. Their rates are periodic.",
    )
    impact: Impact | None = None

    def swapped(self, name: str) -> str:
        """A name after the exchange; twice gives the name back."""
        pairs = {a: b for pair in self.swap for a, b in (pair, pair[::-1])}
        head, _, inner = name.partition("(")
        words = [pairs.get(word, word) for word in head.split(".")]
        if not inner:
            return ".".join(words)
        return f"{'.'.join(words)}({pairs.get(inner[:-1], inner[:-1])})"
