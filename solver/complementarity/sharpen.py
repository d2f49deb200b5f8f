"""From the end of a homotopy to exact pairs, and further down where the polish needs it.

Where both members of a pair are small at the end of a schedule, which of them is zero in the end
is not told yet. A polish that has the wrong ones at zero takes many iterations and comes to
nothing; so it is given few, and what is left of the schedule, or what lies below its end, comes
first.
"""

from collections.abc import Callable
from dataclasses import replace

from schemas.results import HomotopyPass
from solver.complementarity.homotopy import Attempt, Climb, Relaxed, climb
from solver.complementarity.ladder import Ladder
from solver.complementarity.polish import Polished, polish

_SHORTER = 400  # iterations of a pass for a polish's sake, from a good point
_BRIEF = 150  # of a polish
_PATIENT = 600  # of the last one, where nothing else is left

_LAST = 1e-8  # relaxations below are round-off


def sharpened(
    relaxed: Relaxed,
    climbed: Climb,
    attempts: Callable[[int], Attempt],
    on_pass: Callable[[HomotopyPass], None],
) -> tuple[Climb, Polished | None]:
    """The homotopy as far as it went, and what its polish came to; None where there is no point.

    ``attempts`` makes an attempt of at most so many iterations.
    """
    exact = _polished(relaxed, climbed, attempts(_BRIEF))
    while exact is not None and exact.unfinished and (ladder := _rest(climbed)) is not None:
        further = climb(
            relaxed, ladder, attempts(_SHORTER), on_pass, warm=True, near=0.0, before=climbed
        )
        if not climbed.paused:  # the schedule itself has come to its end
            further = replace(further, ladder=replace(further.ladder, levels=()))
        gained, climbed = further.reached != climbed.reached, further
        if not gained:
            break
        exact = _again(relaxed, climbed, attempts(_BRIEF), exact)
    if exact is not None and exact.unfinished:
        exact = _again(relaxed, climbed, attempts(_PATIENT), exact)
    return climbed, exact


def _rest(climbed: Climb) -> Ladder | None:
    """What is left of a schedule, or what lies below its end."""
    if climbed.paused:
        return climbed.ladder
    done = climbed.reached is not None and not climbed.ladder.levels and not climbed.over
    return climbed.ladder.further() if done and (climbed.reached or 0.0) > _LAST else None


def _polished(relaxed: Relaxed, climbed: Climb, attempt: Attempt) -> Polished | None:
    if climbed.reached is None or climbed.over:
        return None
    return polish(relaxed, climbed.outcome, climbed.reached, attempt)


def _again(relaxed: Relaxed, climbed: Climb, attempt: Attempt, before: Polished) -> Polished | None:
    """Another polish, with what both took."""
    exact = _polished(relaxed, climbed, attempt)
    return exact and replace(
        exact,
        iterations=before.iterations + exact.iterations,
        seconds=before.seconds + exact.seconds,
    )
