"""A guess is for states and controls, has one value for every time, and can be evaluated."""

from collections.abc import Iterator
from itertools import pairwise
from math import isclose

from schemas.checks.constants import Constants
from schemas.checks.limits import is_variable, not_a_variable
from schemas.checks.places import variables
from schemas.checks.poses import poses
from schemas.errors import Issue
from schemas.expressions.tokens import MAX_CONSTANT
from schemas.guesses import (
    ConstantGuess,
    Guess,
    PointsGuess,
    PosesGuess,
    RandomGuess,
    SolutionGuess,
)
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.results import CurveGroup
from schemas.values import Scalar

_SAME = 1e-9  # relative, and in seconds

_Numbered = list[tuple[int, Phase]]


def check(problem: Problem) -> Iterator[Issue]:
    """The problem's guess, of which each phase takes what it knows, and those of phases."""
    numbered = list(enumerate(problem.phases))
    yield from _guess(problem.guess, numbered, ())
    for index, phase in numbered:
        if phase.guess is not None:
            yield from _guess(phase.guess, [(index, phase)], ("phases", index))


def _guess(guess: Guess, phases: _Numbered, root: tuple[Part, ...]) -> Iterator[Issue]:
    place = (*root, "guess")
    if isinstance(guess, RandomGuess) and guess.about is not None:
        guess, place = guess.about, (*place, "about")
    if isinstance(guess, PosesGuess):
        yield from poses(guess, phases, place)
    if isinstance(guess, PointsGuess):
        yield from _points(guess, place)
    if isinstance(guess, SolutionGuess):
        yield from _solution(guess, phases, place)
    if isinstance(guess, ConstantGuess | PointsGuess):
        yield from _values(guess, phases, (*place, "values"))


def _values(
    guess: ConstantGuess | PointsGuess, phases: _Numbered, place: tuple[Part, ...]
) -> Iterator[Issue]:
    """Each name is known in some phase, and its values are constants in each that knows it."""
    known = [variables(phase) for _, phase in phases]
    constants = [Constants.of(phase, ("phases", index)) for index, phase in phases]
    for one in constants:
        one.issues.clear()  # the parameters' issues are reported by the check of limits
    for name, values in guess.values.items():
        parts: tuple[Part, ...] = (*place, name)
        users = [one for one, some in zip(constants, known, strict=True) if is_variable(name, some)]
        if not users:
            merged = {word: order for some in known for word, order in some.items()}
            yield not_a_variable(name, merged, parts)
        for one in users:
            if isinstance(values, Scalar):
                one.value(values, parts)
            else:
                for index, value in enumerate(values):
                    one.value(value, (*parts, index))
            found = list(one.drain())
            yield from found
            if found:
                break


def _points(guess: PointsGuess, place: tuple[Part, ...]) -> Iterator[Issue]:
    yield from _increasing(guess.time, (*place, "time"), "times")
    for name, values in guess.values.items():
        if len(values) != len(guess.time):
            yield Issue(
                pointer(*place, "values", name),
                f"{len(values)} values for {len(guess.time)} times",
                "give one value for every time",
            )


def _increasing(times: list[float], place: tuple[Part, ...], what: str) -> Iterator[Issue]:
    for index, time in enumerate(times):
        if abs(time) > MAX_CONSTANT:
            yield Issue(pointer(*place, index), f"a time over {MAX_CONSTANT:g} in size")
    for index, (before, after) in enumerate(pairwise(times), start=1):
        if after <= before:
            message = f"{what} increase, but {after:g} follows {before:g}"
            yield Issue(pointer(*place, index), message)


def _solution(guess: SolutionGuess, phases: _Numbered, place: tuple[Part, ...]) -> Iterator[Issue]:
    place = (*place, "phases")
    names: set[str] = set()
    for index, phase in enumerate(guess.phases):
        if phase.name in names:
            message = f"'{phase.name}' is already the name of a phase of this guess"
            yield Issue(pointer(*place, index, "name"), message, "give one of each name")
        names.add(phase.name)
        for group, curves in phase.curves.items():
            yield from _curves(curves, (*place, index, "curves", group))
        yield from _one_span(phase.curves, (*place, index, "curves"))
    wanted = [phase.name for _, phase in phases]
    known = {name.partition("/")[0] for name in names}  # PHASE/MODE is of PHASE
    if not (len(guess.phases) == len(wanted) == 1 or known.intersection(wanted)):
        hint = f"phases are matched by name; here they are {', '.join(wanted[:12])}"
        yield Issue(pointer(*place), "no phase of this guess is a phase of the problem", hint)


def _one_span(groups: dict[str, CurveGroup], place: tuple[Part, ...]) -> Iterator[Issue]:
    """All curves of a phase start together and end together, but for rounding."""
    spans = {
        name: (group.breaks[0], group.breaks[-1]) for name, group in groups.items() if group.breaks
    }
    first = next(iter(spans.values()), (0.0, 0.0))
    for name, span in spans.items():
        pairs = zip(span, first, strict=True)
        if not all(isclose(one, other, rel_tol=_SAME, abs_tol=_SAME) for one, other in pairs):
            yield Issue(
                pointer(*place, name, "breaks"),
                f"from {span[0]:g} to {span[1]:g} s, where '{next(iter(spans))}' goes from "
                f"{first[0]:g} to {first[1]:g} s",
                "the curves of a phase span the same time",
            )


def _curves(group: CurveGroup, place: tuple[Part, ...]) -> Iterator[Issue]:
    """Breaks increase; a series has one row of coefficients per segment, without gaps."""
    breaks = (*place, "breaks")
    if len(group.breaks) < 2:
        yield Issue(pointer(*breaks), "a curve needs two breaks or more", "give its start and end")
    yield from _increasing(group.breaks, breaks, "breaks")
    for name, rows in group.coefficients.items():
        parts = (*place, "coefficients", name)
        if len(rows) != len(group.breaks) - 1:
            message = f"{len(rows)} rows of coefficients for {len(group.breaks) - 1} segments"
            yield Issue(pointer(*parts), message, "give one row for every segment")
        for index, row in enumerate(rows):
            if not row or None in row:
                message = "no coefficients" if not row else "a coefficient is missing (null)"
                hint = "leave the series out; it then takes the linear guess"
                yield Issue(pointer(*parts, index), message, hint)
                break
