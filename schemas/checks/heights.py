"""Grounds that step or have poles: motions over them have no normal direction there."""

import math
import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from schemas.checks.masses import Numbers
from schemas.errors import Issue
from schemas.expressions import Call, Expression, ExpressionError, Tree, constant, names_in, walk
from schemas.mechanisms.contacts import HEIGHT_NAME

_REACH, _STEP = 20.0, 0.1
_STEEP, _JUMP = 4.0, 1e-3
_HALVINGS = 40
_ENDLESS = 1e6  # m; beyond lies a pole
_ROUND = 9  # decimals of the place of a step
_LONG = 120  # characters of a height that a mend repeats
_SIGN = re.compile(r"\bsign\s*\(([^()]*)\)")


class _Step(NamedTuple):
    """Where a height jumps, and the heights on both sides, m."""

    place: float
    before: float
    after: float


def check_height(height: Expression, where: str, numbers: Numbers) -> Iterator[Issue]:
    """An issue for the height of a surface that jumps, or grows without end."""
    call = of_place(height.tree, ("sign",))
    if call is not None:
        message = f"with {call.function} the ground has a vertical step"
        yield Issue(where, message, _mend(_ramped(height.text)), call.column)
        return
    step = _jump(height, numbers)
    if step is None:
        return
    at = f"x = {round(step.place, _ROUND) + 0.0:.4g}"
    if not max(abs(step.before), abs(step.after)) < _ENDLESS:
        mend = "a height is finite everywhere: keep what it is divided by away from 0"
        yield Issue(where, f"the ground rises or falls without end near {at}", mend)
        return
    yield Issue(where, f"the ground has a vertical step at {at}", _mend(_ramp(step)))


def of_place(height: Tree, functions: Sequence[str]) -> Call | None:
    """The first of some functions that the place enters."""
    calls = [one for one in walk(height) if isinstance(one, Call) and one.function in functions]
    found = (one for one in calls if any(n.name == HEIGHT_NAME for n in names_in(one)))
    return next(found, None)


def _mend(ramp: str) -> str:
    return (
        f"write it as a steep ramp, such as {ramp}, or as a second surface that some contacts may "
        "touch ('pairs')"
    )


def _ramped(text: str) -> str:
    """The height with tanh for sign, so that its steps keep their size."""

    def tanh(found: re.Match[str]) -> str:
        inner = found[1].strip()
        return f"tanh({inner}/0.01)" if inner.isidentifier() else f"tanh(({inner})/0.01)"

    ramped = _SIGN.sub(tanh, text)
    return "tanh(x/0.01) for sign(x)" if ramped == text or len(ramped) > _LONG else ramped


def _ramp(step: _Step) -> str:
    """A ramp as high as a step, at its place."""
    place = round(step.place, _ROUND)
    along = "x" if place == 0 else f"(x {'-' if place > 0 else '+'} {abs(place):.4g})"
    middle, half = (step.before + step.after) / 2, (step.after - step.before) / 2
    foot = "" if abs(middle) < _JUMP else f"{middle:.4g} + "
    return f"{foot}{half:.4g}*tanh({along}/0.01)"


def _jump(height: Expression, numbers: Numbers) -> _Step | None:
    """Where the height jumps, near the origin; searched where it is steep, down to rounding."""
    if not any(name.name == HEIGHT_NAME for name in names_in(height.tree)):
        return None
    count = round(2 * _REACH / _STEP) + 1
    grid = [-_REACH + _STEP * (i + 0.123) for i in range(count)]
    heights = [_at(height, x, numbers) for x in grid]
    for i in range(count - 1):
        if abs(heights[i + 1] - heights[i]) > _STEEP * _STEP:
            found = _narrowed(height, grid[i], grid[i + 1], numbers)
            if found is not None:
                return found
    return None


def _narrowed(height: Expression, left: float, right: float, numbers: Numbers) -> _Step | None:
    a, b = _at(height, left, numbers), _at(height, right, numbers)
    for _ in range(_HALVINGS):
        middle = (left + right) / 2
        value = _at(height, middle, numbers)
        if abs(value - a) > abs(b - value):
            right, b = middle, value
        else:
            left, a = middle, value
    return _Step((left + right) / 2, a, b) if abs(b - a) > _JUMP else None


def _at(height: Expression, x: float, numbers: Numbers) -> float:
    try:
        return constant(height.tree, {**numbers.known, HEIGHT_NAME: x})
    except ExpressionError:
        return math.nan
