"""Absolute values that are to be exact can be; those that are to be smooth stay small."""

from collections.abc import Iterator

from schemas.checks.places import places
from schemas.epigraph import epigraph
from schemas.errors import Issue
from schemas.expressions.smoothing import smoothed_size
from schemas.limits import MODEL_LIMITS
from schemas.pointers import pointer
from schemas.problem import Problem


def check(problem: Problem) -> Iterator[Issue]:
    """Slacks that nothing would press, and smooth forms over the limit in size."""
    if problem.nonsmooth is None:
        return
    if problem.nonsmooth.abs == "slack":
        for index in range(len(problem.phases)):
            yield from epigraph(problem, index).issues
        return
    for place in places(problem):
        size = smoothed_size(place.expression.tree)
        if size > MODEL_LIMITS.nodes:
            yield Issue(
                pointer(*place.parts),
                f"its smooth form has {size} operations, names and numbers, "
                f"at most {MODEL_LIMITS.nodes} are allowed",
                "nest abs, min and max less deeply",
            )
            return
