"""What the variables of contacts and limits are called; those with a ``#`` no user can write.

The slip of a contact is a variable too: its row spans a step, and the method makes it.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import count, takewhile


@dataclass(frozen=True, slots=True)
class _Names:
    """Of one contact, in the plane or in space."""

    pair: str

    @property
    def normal(self) -> str:
        """The normal force, N."""
        return f"contact.{self.pair}.normal"

    @property
    def gap(self) -> str:
        """The slack that is the gap, m."""
        return f"contact.{self.pair}#gap"

    @property
    def speed(self) -> str:
        """How fast it slips, m/s: gamma of 000."""
        return f"contact.{self.pair}#speed"

    @property
    def spare(self) -> str:
        """What is left of the friction cone, N."""
        return f"contact.{self.pair}#spare"


class ContactNames(_Names):
    """Of one permitted pair."""

    __slots__ = ()

    @property
    def tangential(self) -> str:
        """The force along the tangent: right less left, N."""
        return f"contact.{self.pair}.tangential"

    @property
    def right(self) -> str:
        """The part of the tangential force along the tangent, N."""
        return f"contact.{self.pair}#right"

    @property
    def left(self) -> str:
        """The part against it, N."""
        return f"contact.{self.pair}#left"

    @property
    def slip(self) -> str:
        """The slip of a step, m/s."""
        return f"contact.{self.pair}#slip"

    @property
    def ahead(self) -> str:
        """Speed plus slip, m/s: nothing while it slips to the left."""
        return f"contact.{self.pair}#ahead"

    @property
    def behind(self) -> str:
        """Speed less slip, m/s: nothing while it slips to the right."""
        return f"contact.{self.pair}#behind"


class SpaceNames(_Names):
    """Of one contact in space; its friction pushes along some directions, numbered from x on."""

    __slots__ = ()

    @property
    def tangential(self) -> tuple[str, str]:
        """The friction along x and y, N."""
        return f"contact.{self.pair}.tangential_x", f"contact.{self.pair}.tangential_y"

    @property
    def slips(self) -> tuple[str, str]:
        """The slack that is the slip along x and y, m/s."""
        return f"contact.{self.pair}#slip_x", f"contact.{self.pair}#slip_y"

    def push(self, direction: int) -> str:
        """The part of the friction along a direction, N."""
        return f"contact.{self.pair}#push{direction}"

    def pushes(self, controls: Iterable[str]) -> list[str]:
        """Those that are among some controls, in order."""
        known = set(controls)
        return list(takewhile(known.__contains__, map(self.push, count())))

    def ahead(self, direction: int) -> str:
        """Speed plus the slip along a direction, m/s: nothing while it slips against it."""
        return f"contact.{self.pair}#ahead{direction}"


@dataclass(frozen=True, slots=True)
class LimitNames:
    """Of one joint with limits."""

    joint: str

    @property
    def effort(self) -> str:
        """What its stops do together, N or N m."""
        return f"limit.{self.joint}"

    @property
    def lower(self) -> str:
        """The effort of the lower stop."""
        return f"limit.{self.joint}#lower"

    @property
    def upper(self) -> str:
        """The effort of the upper stop, against the coordinate."""
        return f"limit.{self.joint}#upper"

    @property
    def below(self) -> str:
        """How far the lower stop is, m or rad."""
        return f"limit.{self.joint}#below"

    @property
    def above(self) -> str:
        """How far the upper stop is, m or rad."""
        return f"limit.{self.joint}#above"
