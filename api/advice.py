"""What a good problem's author may still want to know; part of ``?validate_only=true``."""

from schemas.corners import corners
from schemas.guesses import RandomGuess
from schemas.problem import Limits, Problem


def warnings(problem: Problem, limits: Limits) -> list[str]:
    """Notes on limits that the service lowers to ``limits``, on guesses, on corners."""
    lowered = [
        f"/limits/{name}: {getattr(problem.limits, name):g} becomes {getattr(limits, name):g}, "
        "the most this service gives"
        for name in Limits.model_fields
        if getattr(limits, name) < getattr(problem.limits, name)
    ]
    if problem.multistart > 1 and not isinstance(problem.guess, RandomGuess):
        lowered.append(
            "/multistart: the first guess is the problem's own, the others are random ones with "
            f"the seeds 1 to {problem.multistart - 1}"
        )
    return [*lowered, *corners(problem)]
