"""What a good document's author may still want to know; part of ``?validate_only=true``."""

from collections.abc import Iterator

from schemas.problem import Limits, Problem
from schemas.remarks import remarks


def warnings(problem: Problem, limits: Limits) -> list[str]:
    """Notes on limits that the service lowers to ``limits``, and what `remarks` has to say."""
    return [*lowered(problem.limits, limits), *remarks(problem)]


def lowered(asked: Limits, given: Limits) -> Iterator[str]:
    """Notes on limits that the service lowers."""
    for name in Limits.model_fields:
        if getattr(given, name) < getattr(asked, name):
            yield (
                f"/limits/{name}: {getattr(asked, name):g} becomes {getattr(given, name):g}, "
                "the most this service gives"
            )
