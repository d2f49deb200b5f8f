"""The rounds: where to split next, from what the last solve shows."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.lowering import lower
from solver.switches.detect import NEAR, detect
from solver.switches.holds import holds
from solver.switches.join import by_phase, join
from solver.switches.samples import Samples
from solver.switches.split import Cut, Plan

ROUNDS = 3
"""Splits of one solve at the most."""

_COLLAPSED = 3.0  # times the shortest duration


def propose(
    problem: Problem,
    results: Sequence[PhaseResult],
    statics: Mapping[str, float],
    plan: Plan | None = None,
) -> list[Cut] | None:
    """Where to split the user's problem, given what was solved.

    Parameters
    ----------
    problem
        The user's.
    results
        Of the problem, or of its parts where it was split before.
    statics
        The values that the solver chose.
    plan
        How it was split; its joints are kept, but where a part has shrunk to nothing. Only what
        jumps is worth another split: the mesh copes with kinks.

    Returns
    -------
    A cut for each phase; None where there is nothing to split, or nothing new.
    """
    parts = [[result] for result in results] if plan is None else by_phase(plan, results)
    phases = list(results) if plan is None else join(plan, results)
    cuts, changed = list[Cut](), False
    for phase, form, whole, own in zip(problem.phases, lower(problem), phases, parts, strict=True):
        kept, new = _joints(own), list[float]()
        samples = Samples.of(form, whole, statics)
        if samples is not None:
            found = detect(phase, samples, kinks=plan is None)
            new = [time for time in found if not _near(time, kept, whole)]
        times = sorted([*kept, *new])
        held = holds(phase, samples, times) if samples is not None else ()
        cuts.append(Cut(whole.knots[0], whole.knots[-1], tuple(times), held))
        changed |= bool(new)
    return cuts if changed else None


def _joints(parts: Sequence[PhaseResult]) -> list[float]:
    """Where the parts meet; both ends of a part that has collapsed are one."""
    start, end = parts[0].knots[0], parts[-1].knots[-1]
    joints: list[float] = []
    for one, _ in itertools.pairwise(parts):
        time = one.knots[-1]
        if min(time - (joints[-1] if joints else start), end - time) > _nothing(start, end):
            joints.append(time)
    return joints


def _near(time: float, joints: Sequence[float], whole: PhaseResult) -> bool:
    """Whether a joint stands within the segment around a time, or next to nothing away."""
    widths, knots = np.diff(whole.knots), np.array(whole.knots)
    place = int(np.clip(np.searchsorted(knots, time) - 1, 0, len(widths) - 1))
    close = max(NEAR * widths[place], _nothing(knots[0], knots[-1]))
    return any(abs(time - joint) <= close for joint in joints)


def _nothing(start: float, end: float) -> float:
    """The duration below which a part has collapsed."""
    return _COLLAPSED * Cut(start, end).shortest
