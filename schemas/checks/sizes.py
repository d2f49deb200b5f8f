"""The size of the model as a whole; limits on single lists are the schema's."""

from collections.abc import Iterator

from schemas.checks.places import places
from schemas.errors import Issue
from schemas.expressions import walk
from schemas.limits import MODEL_LIMITS
from schemas.problem import Problem


def check(problem: Problem) -> Iterator[Issue]:
    """Nodes of all expressions together."""
    nodes = sum(sum(1 for _ in walk(place.expression.tree)) for place in places(problem))
    if nodes > MODEL_LIMITS.nodes:
        yield Issue(
            "",
            f"over the limit 'nodes': {nodes} operations, names and numbers in all expressions "
            f"together, at most {MODEL_LIMITS.nodes}",
            "name what is repeated in 'define'; it then counts once",
        )
