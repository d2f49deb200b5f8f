"""Bounds, ends, constraints and statics: over declared names, evaluable, possible together."""

import math
from collections.abc import Iterator, Mapping

from schemas.checks.constants import Constants, Interval
from schemas.checks.places import limited
from schemas.errors import Issue
from schemas.expressions import derivative, stem
from schemas.habits import as_rate
from schemas.phases import Constraint, Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean


def check(problem: Problem) -> Iterator[Issue]:
    """Parameters, bounds, initial and final values, limits of constraints, statics."""
    alone = Constants()
    yield from _statics(problem, alone)
    for index, phase in enumerate(problem.phases):
        root = ("phases", index)
        constants = Constants.of(phase, root, problem.static)
        yield from constants.drain()
        yield from _bounds(phase, root, constants)
        yield from _constraints(phase.path, (*root, "path"), constants)
        yield from _constraints(phase.boundary, (*root, "boundary"), constants)
    yield from _constraints(problem.linkages, ("linkages",), alone)


def _statics(problem: Problem, constants: Constants) -> Iterator[Issue]:
    for name, static in problem.static.items():
        interval = constants.interval(static.bounds, ("static", name, "bounds"))
        if static.guess is not None:
            parts = ("static", name, "guess")
            guess = constants.value(static.guess, parts)
            if guess is not None and interval is not None:
                yield from _outside((guess, guess), interval, parts)
        yield from constants.drain()


def _bounds(phase: Phase, root: tuple[Part, ...], constants: Constants) -> Iterator[Issue]:
    known = limited(phase)
    along: dict[str, Interval] = {}
    for field in ("bounds", "initial", "final"):
        for name, bound in getattr(phase, field).items():
            parts = (*root, field, name)
            if not is_variable(name, known):
                yield not_a_variable(name, known, parts)
                continue
            interval = constants.interval(bound, parts)
            yield from constants.drain()
            if interval is None:
                continue
            if field == "bounds":
                along[name] = interval
            else:
                yield from _outside(interval, along.get(name), parts)


def is_variable(name: str, known: Mapping[str, int]) -> bool:
    """Whether the name is one of the variables, or a derivative of one that exists."""
    order, base = stem(name)
    return known.get(base, -1) >= order


def not_a_variable(name: str, known: Mapping[str, int], parts: tuple[Part, ...]) -> Issue:
    """The issue of a name that should be a state or a control, or a derivative of one."""
    order, base = stem(name)
    hint = as_rate(name, (word for word, most in known.items() if most))
    hint = hint or did_you_mean(name, [derivative(word, order) for word in known])
    if name == "t":
        hint = "'time' bounds the time"
    elif base in known:
        hint = "a motion in closed form has no derivatives"
    some = "the states and controls are " + ", ".join(list(known)[:12])
    return Issue(pointer(*parts), f"'{name}' is not a state or a control", hint or some)


def _outside(end: Interval, along: Interval | None, parts: tuple[Part, ...]) -> Iterator[Issue]:
    if along is not None and (end[0] > along[1] or end[1] < along[0]):
        yield Issue(
            pointer(*parts),
            f"{_shown(end)} lies outside of the bounds {_shown(along)}",
            "widen 'bounds', or move it into them",
        )


def _shown(interval: Interval) -> str:
    lower, upper = interval
    if lower == upper:
        return f"{lower:g}"
    sides = ("null" if math.isinf(side) else f"{side:g}" for side in interval)
    return "[" + ", ".join(sides) + "]"


def _constraints(
    constraints: list[Constraint], root: tuple[Part, ...], constants: Constants
) -> Iterator[Issue]:
    for index, constraint in enumerate(constraints):
        parts = (*root, index)
        lower, upper = constraint.lower, constraint.upper
        constants.ordered(
            -math.inf if lower is None else constants.value(lower, (*parts, "lower")),
            math.inf if upper is None else constants.value(upper, (*parts, "upper")),
            parts,
        )
        yield from constants.drain()
