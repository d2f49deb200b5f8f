"""Where an issue of the expanded problem stands in the posted one."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from schemas.errors import InvalidModel, Issue
from schemas.pointers import Part, parts_of, pointer
from schemas.problem import Problem
from solver.hybrid.expand import Expansion

_MODE = ["system", "mode"]


@contextmanager
def as_posted(problem: Problem, expansion: Expansion) -> Iterator[None]:
    """Let refusals of modes' phases point into the problem that was posted.

    Raises
    ------
    InvalidModel
        In place of one of the expanded problem.
    """
    try:
        yield
    except InvalidModel as refusal:
        issues = [_posted(issue, problem, expansion) for issue in refusal.issues]
        raise InvalidModel(issues) from None


def _posted(issue: Issue, problem: Problem, expansion: Expansion) -> Issue:
    parts = parts_of(issue.pointer)
    if parts[:1] != ["phases"] or len(parts) < 2:
        return issue
    index, mode = _origin(int(parts[1]), expansion)
    split, rest = expansion.splits[index], parts[2:]
    place: tuple[Part, ...] = ("phases", index, *rest)
    if split is not None and rest[:2] == _MODE:
        own = ("phases", index, "method") if problem.phases[index].method else ("method",)
        place = (*own, "sequence", mode, "contacts", *rest[2:])
    return replace(issue, pointer=pointer(*place))


def _origin(expanded: int, expansion: Expansion) -> tuple[int, int]:
    """The posted phase of one that is solved, and which of its modes that is."""
    for index, split in enumerate(expansion.splits):
        count = 1 if split is None else len(split.names)
        if expanded < count:
            return index, expanded
        expanded -= count
    raise IndexError(expanded)
