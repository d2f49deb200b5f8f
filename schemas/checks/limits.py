"""Bounds, ends and constraints: over declared names, evaluable, and possible together."""

import math
from collections.abc import Iterator

from schemas.checks.constants import Constants, Interval
from schemas.checks.places import variables
from schemas.errors import Issue
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean


def check(problem: Problem) -> Iterator[Issue]:
    """Parameters, bounds, initial and final values, limits of constraints."""
    for index, phase in enumerate(problem.phases):
        root = ("phases", index)
        constants = Constants.of(phase, root)
        yield from constants.drain()
        yield from _bounds(phase, root, constants)
        yield from _constraints(phase, root, constants)


def _bounds(phase: Phase, root: tuple[Part, ...], constants: Constants) -> Iterator[Issue]:
    known = variables(phase)
    along: dict[str, Interval] = {}
    for field in ("bounds", "initial", "final"):
        for name, bound in getattr(phase, field).items():
            parts = (*root, field, name)
            if name not in known:
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


def not_a_variable(name: str, known: list[str], parts: tuple[Part, ...]) -> Issue:
    """The issue of a name that should be a state or a control."""
    hint = "'time' bounds the time" if name == "t" else did_you_mean(name, known)
    some = "the states and controls are " + ", ".join(known[:12])
    return Issue(pointer(*parts), f"'{name}' is not a state or a control", hint or some)


def _outside(end: Interval, along: Interval | None, parts: tuple[Part, ...]) -> Iterator[Issue]:
    if along is not None and (end[0] > along[1] or end[1] < along[0]):
        yield Issue(
            pointer(*parts),
            f"{_shown(end)} lies outside of the bounds {_shown(along)}",
            "widen 'bounds', or move the end into them",
        )


def _shown(interval: Interval) -> str:
    lower, upper = interval
    if lower == upper:
        return f"{lower:g}"
    sides = ("null" if math.isinf(side) else f"{side:g}" for side in interval)
    return "[" + ", ".join(sides) + "]"


def _constraints(phase: Phase, root: tuple[Part, ...], constants: Constants) -> Iterator[Issue]:
    for field in ("path", "boundary"):
        for index, constraint in enumerate(getattr(phase, field)):
            parts = (*root, field, index)
            lower, upper = constraint.lower, constraint.upper
            constants.ordered(
                -math.inf if lower is None else constants.value(lower, (*parts, "lower")),
                math.inf if upper is None else constants.value(upper, (*parts, "upper")),
                parts,
            )
            yield from constants.drain()
