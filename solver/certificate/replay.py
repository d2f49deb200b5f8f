"""The audit's replays: reported, since open-loop motions amplify whatever there is."""

import math
from collections.abc import Iterator

import numpy as np

from schemas.results import Check, finite
from solver.certificate.case import Case
from solver.certificate.stepped import ContactCase

FIRST = 0.15
"""The seconds that are told on their own: later an unstable motion amplifies anything."""


def early_replay(case: Case) -> Check | None:
    """The largest difference of a coordinate over the first 0.15 s, m or rad."""
    return _told("replay of 0.15 s", case, FIRST)


def whole_replay(case: Case) -> Check | None:
    """The same over the whole phase."""
    return _told("replay", case, math.inf)


def _told(name: str, case: Case, span: float) -> Check | None:
    """One row: the larger difference of the two replays, and both in words."""
    told = [one for phase in case.stepped for one in _compared(phase, span)]
    if not told:
        return None
    worst = max(size for size, _ in told)
    return Check(
        name=name,
        value=finite(worst),
        tolerance=None,
        unit="m, rad",
        passed=math.isfinite(worst),
        judged=False,
        where="; ".join(words for _, words in told),
    )


def _compared(phase: ContactCase, span: float) -> Iterator[tuple[float, str]]:
    knots = phase.steps.published.knots
    for parts, found in phase.replays.items():
        count = min(found.q.shape[1], int(np.sum(knots <= knots[0] + span * (1 + 1e-9))))
        apart = np.abs(found.q[:, :count] - phase.steps.published.q[:, :count])
        row, knot = np.unravel_index(int(np.argmax(apart)), apart.shape)
        size, place = float(apart[row, knot]), phase.steps.model.coordinates[row]
        steps = "the same steps" if parts == 1 else f"{parts} times smaller steps"
        words = f"phase {phase.name}, {steps}: {size:.3g} of {place} at t = {knots[knot]:.4g} s"
        ended = f", {found.ended}" if found.ended and count == found.q.shape[1] else ""
        yield size, words + ended
