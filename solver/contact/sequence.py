"""The mode sequence that contact-implicit steps found: nobody gave it (000, figures 6 and 8)."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from schemas.phases import Phase
from schemas.results import ModeSequence, ModeSpan, PhaseResult
from solver.contact.flicker import FREE, FRICTIONLESS, Array, Pressed, Steps, doing
from solver.contact.readings import Readings, Stepped, readings
from solver.trajectory import Trajectory

Statics = Mapping[str, float]


def contact_sequence(phase: Phase, result: PhaseResult, statics: Statics) -> ModeSequence | None:
    """What every contact and limit did, from the published places and forces.

    Parameters
    ----------
    phase
        As posted, its method with the discretisation that was used.
    result
        Its published result: states at the knots, forces of the steps.
    statics
        The values of the problem's statics.

    Returns
    -------
    ModeSequence or None
        None where nothing may touch.
    """
    if not _steps(result):
        return None
    stepped = Stepped.of_result(phase, result)
    return sequence_of(stepped.knots, readings(phase, stepped, statics, guessed=False))


def guessed_sequence(
    phase: Phase, guess: Trajectory, fractions: Array, statics: Statics
) -> ModeSequence | None:
    """The same of a guess, to be compared; without forces by its gaps alone.

    ``fractions`` of its duration are the knots, (N + 1,).
    """
    stepped = Stepped.of_guess(phase, guess, fractions)
    return sequence_of(stepped.knots, readings(phase, stepped, statics, guessed=True))


def sequence_of(knots: Array, found: Readings) -> ModeSequence | None:
    """Modes from what was read: steps in which all contacts do the same are one."""
    if not found.rows:
        return None
    table = {name: _doing(sides, found.steps) for name, sides in found.rows.items()}
    modes: list[ModeSpan] = []
    for (start, end), words in zip(
        pairwise(np.asarray(knots).tolist()), zip(*table.values(), strict=True), strict=True
    ):
        touching = {name: word for name, word in zip(table, words, strict=True) if word != FREE}
        if modes and modes[-1].contacts == touching:
            modes[-1] = modes[-1].model_copy(update={"end": end})
            continue
        modes.append(ModeSpan(start=start, end=end, contacts=touching))
    return _counted(list(table), modes, math.prod(map(_alternatives, found.rows.values())))


def joined(sequences: Iterable[ModeSequence | None]) -> ModeSequence | None:
    """Those of several phases, in order of time, as one."""
    known = [one for one in sequences if one is not None]
    if not known:
        return None
    names = list(dict.fromkeys(name for one in known for name in one.contacts))
    possible = max(one.possible for one in known)
    return _counted(names, [mode for one in known for mode in one.modes], possible)


def _counted(names: list[str], modes: list[ModeSpan], possible: int) -> ModeSequence:
    distinct = {frozenset(mode.contacts.items()) for mode in modes}
    return ModeSequence(contacts=names, modes=modes, distinct=len(distinct), possible=possible)


def _doing(sides: Sequence[Pressed], steps: Steps) -> list[str]:
    """What one contact does, or the two stops of one joint."""
    words = [doing(side, steps) for side in sides]
    return [next((word for word in one if word != FREE), FREE) for one in zip(*words, strict=True)]


def _alternatives(sides: Sequence[Pressed]) -> int:
    """In how many ways it may touch, and that it may not."""
    return 1 + sum(_ways(side) for side in sides)


def _ways(side: Pressed) -> int:
    if side.slips is None or side.word == FRICTIONLESS:
        return 1
    return 3 if side.slips.ndim == 1 else 2


def _steps(result: PhaseResult) -> bool:
    states = result.groups.get("states")
    return states is not None and len(result.knots) > 1 and len(states.time) == len(result.knots)
