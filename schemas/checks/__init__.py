"""What a well-formed problem may still get wrong: names, values, sizes.

A check takes the problem and yields issues. ``CHECKS`` is the list of all; a new one is one
file and one entry.
"""

from collections.abc import Callable, Iterator

from schemas.checks import (
    chains,
    closed_forms,
    contact_implicit,
    contacts,
    drives,
    equations,
    guesses,
    limits,
    masses,
    methods,
    names,
    nonsmooth,
    parts,
    references,
    schedules,
    sizes,
    times,
    trees,
    urdf,
)
from schemas.errors import Issue
from schemas.problem import Problem

Check = Callable[[Problem], Iterator[Issue]]

CHECKS: tuple[Check, ...] = (
    names.check,
    parts.check,
    masses.check,
    drives.check,
    contacts.check,
    equations.check,
    references.check,
    chains.check,
    closed_forms.check,
    limits.check,
    urdf.check,
    times.check,
    methods.check,
    schedules.check,
    contact_implicit.check,
    guesses.check,
    nonsmooth.check,
)


def check(problem: Problem) -> Iterator[Issue]:
    """Every issue of every check, found while they are asked for.

    A problem over a size limit, or with a mechanism that does not hang together, is not looked
    into any further.
    """
    over = list(sizes.check(problem))
    if over:
        yield from over
        return
    broken = list(torn(problem))
    if broken:
        own = [*names.check(problem), *parts.shared(problem)]
        yield from dict.fromkeys([*own, *broken])
        return
    for one in CHECKS:
        yield from one(problem)


def torn(problem: Problem) -> list[Issue]:
    """Why bodies of a mechanism do not hang together.

    Its states follow from that, so all else that could be said about names would mislead.
    """
    return list(parts.unjoined(problem)) or list(trees.check(problem))
