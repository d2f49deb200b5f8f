"""A guess is for states and controls, and has one value for every time."""

from collections.abc import Iterator
from itertools import pairwise

from schemas.checks.constants import Constants
from schemas.checks.limits import not_a_variable
from schemas.checks.places import variables
from schemas.errors import Issue
from schemas.expressions.tokens import MAX_CONSTANT
from schemas.pointers import Part, pointer
from schemas.guesses import ConstantGuess, PointsGuess
from schemas.problem import Problem
from schemas.values import Scalar


def check(problem: Problem) -> Iterator[Issue]:
    """Names, constants and lengths of the guess."""
    guess, phase = problem.guess, problem.phases[0]
    if isinstance(guess, PointsGuess):
        yield from _points(guess)
    if not isinstance(guess, ConstantGuess | PointsGuess):
        return
    known = variables(phase)
    constants = Constants.of(phase, ("phases", 0))
    constants.issues.clear()  # the parameters' issues are reported by the check of limits
    for name, values in guess.values.items():
        parts: tuple[Part, ...] = ("guess", "values", name)
        if name not in known:
            yield not_a_variable(name, known, parts)
        elif isinstance(values, Scalar):
            constants.value(values, parts)
        else:
            for index, value in enumerate(values):
                constants.value(value, (*parts, index))
        yield from constants.drain()


def _points(guess: PointsGuess) -> Iterator[Issue]:
    for index, time in enumerate(guess.time):
        if abs(time) > MAX_CONSTANT:
            yield Issue(pointer("guess", "time", index), f"a time over {MAX_CONSTANT:g} in size")
    for index, (before, after) in enumerate(pairwise(guess.time), start=1):
        if after <= before:
            place = pointer("guess", "time", index)
            yield Issue(place, f"times increase, but {after:g} follows {before:g}")
    for name, values in guess.values.items():
        if len(values) != len(guess.time):
            yield Issue(
                pointer("guess", "values", name),
                f"{len(values)} values for {len(guess.time)} times",
                "give one value for every time",
            )
