"""What a good problem's author may still want to know; part of ``?validate_only=true``."""

from schemas.problem import Limits, Problem
from schemas.remarks import remarks


def warnings(problem: Problem, limits: Limits) -> list[str]:
    """Notes on limits that the service lowers to ``limits``, and what `remarks` has to say."""
    lowered = [
        f"/limits/{name}: {getattr(problem.limits, name):g} becomes {getattr(limits, name):g}, "
        "the most this service gives"
        for name in Limits.model_fields
        if getattr(limits, name) < getattr(problem.limits, name)
    ]
    return [*lowered, *remarks(problem)]
