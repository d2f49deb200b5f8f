"""What a contact or a stop does in each step; flicker is left out by its physical weight."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.contact.thresholds import BLOW, CLOSED, LENGTH, PRESSING, SLIDING, SLOWEST, WAY

Array = NDArray[np.float64]

FREE: Final = "free"
STICKING: Final = "sticking"
LEFT: Final = "sliding_left"
RIGHT: Final = "sliding_right"
SLIDES: Final = (LEFT, RIGHT, "sliding")
FRICTIONLESS: Final = "frictionless"


@dataclass(frozen=True, slots=True)
class Steps:
    """The steps of a phase, N of them.

    Attributes
    ----------
    lengths
        s, (N,).
    weight
        N, what forces are compared with.
    speed
        m/s, the fastest slip of any contact.
    """

    lengths: Array
    weight: float
    speed: float = 0.0


@dataclass(frozen=True, slots=True)
class Pressed:
    """A contact along N steps, or one stop of a joint.

    Attributes
    ----------
    gaps
        m (rad at hinges), at the knots, (N + 1,).
    impulses
        Normal ones of the steps, N s (N m s at hinges), (N,); None where no forces are known.
    slips
        m/s along the tangent, (N,), or (2, N) of two tangents in space; None without friction.
    spare
        N s, by how much friction could have been stronger, (N,); None where no forces are known.
    word
        What it does where it touches, unless its slips tell.
    """

    gaps: Array
    impulses: Array | None = None
    slips: Array | None = None
    spare: Array | None = None
    word: str = STICKING


class Run(NamedTuple):
    """Steps from ``first`` up to ``end``, exclusive, that have one ``word``."""

    word: str
    first: int
    end: int

    @property
    def steps(self) -> slice:
        """Its place among the steps."""
        return slice(self.first, self.end)


def doing(one: Pressed, steps: Steps) -> list[str]:
    """What it does in each step: free, or touching in its way; N words."""
    touches = _without_slight_touches(one, steps, _without_slits(one, _pressing(one, steps)))
    if one.slips is None:
        return [one.word if touching else FREE for touching in touches]
    words: list[str] = np.where(touches, _slid(one.slips, steps), FREE).tolist()
    for run in list(runs([FREE if word == FREE else "touching" for word in words])):
        if run.word != FREE:
            words[run.steps] = _settled(one, steps, words, run)
    return words


def runs(words: Sequence[str]) -> Iterator[Run]:
    """Equal words behind one another, in order."""
    first = 0
    for word, group in groupby(words):
        end = first + len(list(group))
        yield Run(word, first, end)
        first = end


def _pressing(one: Pressed, steps: Steps) -> NDArray[np.bool_]:
    """Steps that end closed: of gap and force the larger one is not zero."""
    closed = one.gaps[1:]
    if one.impulses is None:
        return np.asarray(closed <= CLOSED)
    share = one.impulses / np.maximum(steps.weight * steps.lengths, 1e-300)
    return np.asarray((share > PRESSING) & (share > closed / LENGTH))


def _without_slits(one: Pressed, touches: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Openings between two touches through which nothing can be seen are closed."""
    kept = touches.copy()
    for run in _runs_of(touches, value=False):
        between = run.first > 0 and run.end < len(touches)
        if between and one.gaps[run.first : run.end + 1].max() <= CLOSED:
            kept[run.steps] = True
    return kept


def _without_slight_touches(
    one: Pressed, steps: Steps, touches: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Touches whose impulse moves nothing are none."""
    kept = touches.copy()
    for run in _runs_of(touches, value=True) if one.impulses is not None else ():
        if one.impulses is not None and one.impulses[run.steps].sum() < BLOW * steps.weight:
            kept[run.steps] = False
    return kept


def _runs_of(flags: NDArray[np.bool_], *, value: bool) -> list[Run]:
    return [run for run in runs([str(bool(flag)) for flag in flags]) if run.word == str(value)]


def _slid(slips: Array, steps: Steps) -> NDArray[np.str_]:
    """Sticking or sliding, by the slip of each step alone."""
    least = max(SLIDING * steps.speed, SLOWEST)
    if slips.ndim > 1:
        return np.where(np.hypot(*slips) > least, SLIDES[2], STICKING)
    moving = np.where(slips > 0, RIGHT, LEFT)
    return np.where(np.abs(slips) > least, moving, STICKING)


def _settled(one: Pressed, steps: Steps, words: list[str], touch: Run) -> list[str]:
    """The words of one touch, without those that are too slight; the slightest goes first."""
    now = words[touch.steps]
    while True:
        parts = list(runs(now))
        slight = [
            (weight, index)
            for index in range(len(parts))
            if (weight := _weight(one, steps, parts, index, touch.first)) < 1.0
        ]
        if not slight:
            return now
        index = min(slight)[1]
        part = parts[index]
        now[part.steps] = [_instead(parts, index)] * (part.end - part.first)


def _weight(one: Pressed, steps: Steps, parts: Sequence[Run], index: int, first: int) -> float:
    """How much a run weighs, over the least that makes a mode of its own."""
    part = parts[index]
    where = slice(first + part.first, first + part.end)
    if part.word in SLIDES and one.slips is not None:
        return _way(one.slips, steps, where) / WAY
    if 0 < index < len(parts) - 1 and one.spare is not None:  # between slides: friction tells
        return float(one.spare[where].sum() / max(BLOW * steps.weight, 1e-300))
    return np.inf


def _way(slips: Array, steps: Steps, where: slice) -> float:
    """How far a slide came from where it began, m."""
    came = np.cumsum(slips[..., where] * steps.lengths[where], axis=-1)
    return float(np.max(np.linalg.norm(np.atleast_2d(came), axis=0)))


def _instead(parts: Sequence[Run], index: int) -> str:
    """What a run becomes that is too slight: what is beside it."""
    beside = [parts[i].word for i in (index - 1, index + 1) if 0 <= i < len(parts)]
    if parts[index].word == STICKING:
        return beside[0]
    return STICKING if STICKING in beside or not beside else beside[0]
