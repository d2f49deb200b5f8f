"""The mode sequence of a result: which contacts touched when, and how."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any

FREE = "free"
"""What a contact or joint limit does that a mode leaves out."""

SYMBOLS = {
    FREE: ".",
    "sticking": "#",
    "sliding_left": "<",
    "sliding_right": ">",
    "sliding": "~",
    "frictionless": "=",
    "lower": "_",
    "upper": "^",
}
"""One letter for everything that a contact or limit may do."""

_OTHER = "*"


@dataclass(frozen=True)
class Mode:
    """From ``start`` to ``end``, in s: what each touching contact or limit does, by its name."""

    start: float
    end: float
    contacts: dict[str, str]


@dataclass(frozen=True)
class Transition:
    """At ``time``, in s, the contact ``name`` goes from doing ``before`` to doing ``after``."""

    time: float
    name: str
    before: str
    after: str


@dataclass(frozen=True)
class ModeSequence:
    """The modes of a motion in order of time.

    ``contacts`` are the names of all contacts that may touch and, under contact-implicit methods,
    of the joints' limits, ``limit.JOINT``. Of ``possible`` modes ``distinct`` ones occur.
    """

    contacts: list[str]
    modes: list[Mode]
    distinct: int
    possible: int

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> "ModeSequence":
        """Read the JSON of a mode sequence."""
        modes = [Mode(one["start"], one["end"], dict(one["contacts"])) for one in document["modes"]]
        return cls(list(document["contacts"]), modes, document["distinct"], document["possible"])

    @property
    def transitions(self) -> list[Transition]:
        """Every change of a contact or limit, in order of time."""
        return [
            Transition(after.start, name, *change)
            for before, after in pairwise(self.modes)
            for name in self.contacts
            if (change := (_does(before, name), _does(after, name)))[0] != change[1]
        ]

    @property
    def numbers(self) -> list[int]:
        """For each mode which of the distinct ones it is, numbered from 1 as they first occur."""
        known: dict[frozenset[tuple[str, str]], int] = {}
        return [
            known.setdefault(frozenset(mode.contacts.items()), len(known) + 1)
            for mode in self.modes
        ]

    def at(self, time: float) -> dict[str, str]:
        """What touches at a time in s, and how; nothing before the first mode and after the last.

        At a change it is what comes after it.
        """
        found = [mode.contacts for mode in self.modes if mode.start <= time <= mode.end]
        return dict(found[-1]) if found else {}

    def spans(self, name: str) -> list[tuple[float, float, str]]:
        """What one contact or limit does: start, end and word of each stretch, free ones too."""
        return [
            (start, end, word)
            for word, group in groupby(self.modes, key=lambda mode: _does(mode, name))
            for start, end in [_ends(group)]
        ]

    def timeline(self, width: int = 64) -> str:
        """One line for each contact and limit, time from left to right in ``width`` letters.

        The letters are `SYMBOLS`. What touches for less than a letter's time is seen all the same.
        """
        if not self.modes:
            return ""
        margin = max(map(len, self.contacts), default=0)
        start, end = self.modes[0].start, self.modes[-1].end
        ends = [start + (end - start) * i / width for i in range(width + 1)]
        rows = [f"{name:<{margin}}  {''.join(self._letters(name, ends))}" for name in self.contacts]
        seen = dict.fromkeys(word for mode in self.modes for word in mode.contacts.values())
        scale = f"{'':{margin}}  {f'{start:g} s':<{width - 10}}{f'{end:g} s':>10}"
        key = ", ".join(f"{_symbol(word)} {word.replace('_', ' ')}" for word in [*seen, FREE])
        return "\n".join([*rows, scale, f"{'':{margin}}  {key}"])

    def _letters(self, name: str, ends: list[float]) -> Iterator[str]:
        spans = self.spans(name)
        for first, last in pairwise(ends):
            shares = {
                word: min(end, last) - max(start, first)
                for start, end, word in spans
                if min(end, last) > max(start, first)
            }
            touching = {word: share for word, share in shares.items() if word != FREE}
            yield _symbol(max(touching, key=lambda word: touching[word]) if touching else FREE)


def _does(mode: Mode, name: str) -> str:
    return mode.contacts.get(name, FREE)


def _symbol(word: str) -> str:
    return SYMBOLS.get(word, _OTHER)


def _ends(modes: Iterator[Mode]) -> tuple[float, float]:
    first, *others = modes
    return first.start, (others[-1] if others else first).end
