"""A problem whose phases are split at free times: same motion, same cost, more phases."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from schemas import resolve
from schemas.guesses import LinearGuess
from schemas.methods import Method
from schemas.phases import Constraint, Phase, Time
from schemas.problem import Problem
from schemas.values import Bound, Scalar
from solver.lowering import lower
from solver.switches.holds import Hold
from solver.switches.rename import equal, renamed_linkages, renamed_objective, whole_rows

SHORTEST = 1e-4
"""The least duration of a part, as a share of the phase's."""

FEWEST = 4
"""Segments of a part at the least, unless the phase itself has fewer."""


@dataclass(frozen=True, slots=True)
class Cut:
    """Where a phase is split: its ``start`` and ``end``, and the ``times`` between, in seconds.

    ``holds``, if given, say for each of the times which controls rest before and after it.
    """

    start: float
    end: float
    times: tuple[float, ...] = ()
    holds: tuple[Hold, ...] = ()

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Start and end of every part."""
        return list(itertools.pairwise([self.start, *self.times, self.end]))

    @property
    def rests(self) -> list[tuple[Mapping[str, float], Mapping[str, float]]]:
        """The controls that rest at the start and at the end of every part."""
        holds = self.holds or (Hold(),) * len(self.times)
        return list(
            zip([{}, *(h.after for h in holds)], [*(h.before for h in holds), {}], strict=True)
        )

    @property
    def shortest(self) -> float:
        """How short a part may become, in seconds."""
        return SHORTEST * (self.end - self.start)


@dataclass(frozen=True, slots=True)
class Plan:
    """How a problem was split: one cut for each of its phases, most of them without times."""

    problem: Problem
    cuts: tuple[Cut, ...]

    @property
    def counts(self) -> list[int]:
        """The number of parts of each phase; the parts stand one after the other."""
        return [len(cut.spans) for cut in self.cuts]


def split(problem: Problem, cuts: Sequence[Cut]) -> tuple[Problem, Plan]:
    """Split phases into parts that meet at free times.

    A part has the system, the bounds, the path constraints, the integrals and the method of its
    phase. The states, and the controls whose derivatives the problem uses, are continuous from
    part to part; other controls may jump. What the user says of the phase's ends holds for the
    first part's start and the last part's end, and integrals are summed.

    Parameters
    ----------
    cuts
        One for each phase; a phase whose cut has no times stays as it is.
    """
    plan = Plan(problem, tuple(cuts))
    if not any(cut.times for cut in cuts):
        return problem, plan
    continuous = [form.states for form in lower(problem)]
    names_of = {
        phase.name: part_names(phase, cut)
        for phase, cut in zip(problem.phases, cuts, strict=True)
        if cut.times
    }
    parts, linkages = list[Phase](), list[Constraint]()
    for phase, cut, names in zip(problem.phases, cuts, continuous, strict=True):
        parts += _parts(problem, phase, cut)
        if cut.times:
            linkages += whole_rows(problem, phase, part_names(phase, cut))
            linkages += _continuity(phase, cut, names)
    return problem.model_copy(
        update={
            "phases": parts,
            "linkages": [*renamed_linkages(problem, names_of), *linkages],
            "objective": renamed_objective(problem, names_of),
            "guess": LinearGuess(),
            "stages": [],
            "multistart": 1,
        }
    ), plan


def part_names(phase: Phase, cut: Cut) -> list[str]:
    """The phase's own name where it is not split; else names that no user can write."""
    if not cut.times:
        return [phase.name]
    return [f"{phase.name}/{number + 1}" for number in range(len(cut.spans))]


def _parts(problem: Problem, phase: Phase, cut: Cut) -> list[Phase]:
    if not cut.times:
        return [phase]
    names, method = part_names(phase, cut), phase.method or problem.method
    return [
        phase.model_copy(
            update={
                "name": name,
                "time": _time(phase, cut, first=name == names[0], last=name == names[-1]),
                "initial": phase.initial if name == names[0] else _fixed(at_start),
                "final": phase.final if name == names[-1] else _fixed(at_end),
                "boundary": [],
                "method": _method(method, (end - start) / (cut.end - cut.start)),
                "guess": None,
            }
        )
        for name, (start, end), (at_start, at_end) in zip(names, cut.spans, cut.rests, strict=True)
    ]


def _fixed(values: Mapping[str, float]) -> dict[str, Bound]:
    return {name: Bound.read(value) for name, value in values.items()}


def _time(phase: Phase, cut: Cut, *, first: bool, last: bool) -> Time:
    limits = resolve.interval(phase.time.duration, resolve.parameters(phase.system))
    longest = Scalar(limits[1]) if math.isfinite(limits[1]) else None
    return Time(
        initial=phase.time.initial if first else None,
        final=phase.time.final if last else None,
        duration=Bound(Scalar(cut.shortest), longest),
    )


def _method(method: Method, share: float) -> Method:
    """The same with its share of the segments."""
    segments = max(math.ceil(share * method.segments), min(FEWEST, method.segments))
    return method.model_copy(update={"segments": segments})


def _continuity(phase: Phase, cut: Cut, names: Sequence[str]) -> list[Constraint]:
    """States that do not jump from part to part."""
    return [
        equal(f"{name}_continuous", f"{one}.final.{name}", f"{two}.initial.{name}")
        for one, two in itertools.pairwise(part_names(phase, cut))
        for name in names
    ]
