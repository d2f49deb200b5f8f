"""What a well-formed problem may still get wrong: names, values, sizes.

A check takes the problem and yields issues. ``CHECKS`` is the list of all; a new one is one
file and one entry.
"""

from collections.abc import Callable, Iterator

from schemas.checks import (
    chains,
    closed_forms,
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
    trees.check,
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
    guesses.check,
    nonsmooth.check,
)


def check(problem: Problem) -> Iterator[Issue]:
    """Every issue of every check, found while they are asked for.

    A problem over a size limit is not looked into any further.
    """
    over = list(sizes.check(problem))
    if over:
        yield from over
        return
    for one in CHECKS:
        yield from one(problem)
