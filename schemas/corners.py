"""Where a problem's expressions have corners, which gradient-based solvers do not like."""

from collections.abc import Iterator

from schemas.checks.places import Place, places
from schemas.expressions import warnings_in
from schemas.expressions.smoothing import NONSMOOTH
from schemas.pointers import pointer
from schemas.problem import Problem


def corners(problem: Problem) -> Iterator[str]:
    """One line for each kind of corner in an expression, with its place; none where treated."""
    for place in places(problem):
        treated = NONSMOOTH if _is_treated(problem, place) else frozenset[str]()
        for note in warnings_in(place.expression.tree, treated):
            yield f"{pointer(*place.parts)}: {note}"


def _is_treated(problem: Problem, place: Place) -> bool:
    """A smooth form takes the place of all corners, slacks that of those in integrals."""
    if problem.nonsmooth is None:
        return False
    return problem.nonsmooth.abs != "slack" or "integrals" in place.parts[2:3]
