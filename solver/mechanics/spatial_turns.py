"""What one step of a joint does: the rotation, the slide, and their rates, all in its own axes.

A quaternion p need not have the norm 1: with s = p'p the rotation is R(p) / s and the angular
velocity 2 Im(p* p') / s, which are exact for every p but 0. So the motion depends on the direction
of p only, and its norm is free to be held by an equation of its own (`norm_rows`).
"""

from dataclasses import dataclass

from schemas.expressions import Name, Number, Tree, derivative
from schemas.urdf import Step
from solver.mechanics.spatial_vectors import (
    NOWHERE,
    Mat3,
    Vec3,
    apart,
    columns,
    constant,
    cross,
    scaled,
    total,
)
from solver.mechanics.trees import ONE, ZERO, call, less, minus, over, plus, square, times

TWO = Number(2.0)


@dataclass(frozen=True, slots=True)
class Turn:
    """A step in the frame before it (slide) and in the frame after it (turn).

    Attributes
    ----------
    rows
        The rotation's matrix, from the frame after the step to the one before; None for none.
    spin, spinning
        The step's own angular velocity, and what it adds to the angular acceleration, in the axes
        after the step.
    slide, sliding, pushed
        The step's own displacement and its two derivatives, in the axes before the step.
    """

    rows: Mat3 | None = None
    spin: Vec3 = NOWHERE
    spinning: Vec3 = NOWHERE
    slide: Vec3 = NOWHERE
    sliding: Vec3 = NOWHERE
    pushed: Vec3 = NOWHERE


def turn_of(name: str, step: Step, trees: dict[str, Tree]) -> Turn:
    """The step of a body; its shared pieces go into ``trees`` under names that start with it."""
    if step.kind == "ball":
        return _ball(name, step, trees)
    axis = constant(step.axis)
    value, rate, second = (_value(step, order) for order in range(3))
    if step.kind == "slide":
        return Turn(
            slide=scaled(value, axis), sliding=scaled(rate, axis), pushed=scaled(second, axis)
        )
    cosine, sine = Name(f"{name}#cos"), Name(f"{name}#sin")
    trees |= {cosine.name: call("cos", value), sine.name: call("sin", value)}
    return Turn(_plane(step, cosine, sine), scaled(rate, axis), scaled(second, axis))


def _value(step: Step, order: int) -> Tree:
    name = Name(derivative(step.coordinates[0], order))
    moved = times(Number(step.factor), name)
    return moved if order else plus(moved, Number(step.offset))


def _plane(step: Step, cosine: Tree, sine: Tree) -> Mat3:
    """A rotation about x, y or z, the right way round or the other."""
    index = max(range(3), key=lambda one: abs(step.axis[one]))
    if step.axis[index] < 0:
        sine = minus(sine)
    after, last = (index + 1) % 3, (index + 2) % 3
    rows: list[list[Tree]] = [[ZERO] * 3 for _ in range(3)]
    rows[index][index] = ONE
    rows[after][after] = rows[last][last] = cosine
    rows[after][last], rows[last][after] = minus(sine), sine
    first, second, third = ((row[0], row[1], row[2]) for row in rows)
    return first, second, third


def _ball(name: str, step: Step, trees: dict[str, Tree]) -> Turn:
    w, *vector = (Name(one) for one in step.coordinates)
    x, y, z = vector
    rates = [Name(derivative(one)) for one in step.coordinates]
    seconds = [Name(derivative(one, 2)) for one in step.coordinates]
    size, double, drift = Name(f"{name}#s"), Name(f"{name}#double"), Name(f"{name}#drift")
    trees |= {
        size.name: plus(*(square(one) for one in (w, x, y, z))),
        double.name: over(TWO, size),
        drift.name: times(double, _along(step)),
    }
    spin = _shared(f"{name}#ball", scaled(double, _imaginary(step.coordinates, rates)), trees)
    turning = scaled(double, _imaginary(step.coordinates, seconds))
    rows = _matrix(name, (w, x, y, z), double, trees)
    return Turn(rows, spin, apart(turning, scaled(drift, spin)))


def _along(step: Step) -> Tree:
    """The product p'p' of a quaternion with its rate: half the rate of its squared norm."""
    return plus(*(times(Name(one), Name(derivative(one))) for one in step.coordinates))


def _imaginary(names: tuple[str, ...], rates: list[Name]) -> Vec3:
    """Im(p* r) = w r_v - r_w v - v x r_v."""
    w, x, y, z = (Name(one) for one in names)
    along: Vec3 = (rates[1], rates[2], rates[3])
    return apart(apart(scaled(w, along), scaled(rates[0], (x, y, z))), cross((x, y, z), along))


def _matrix(name: str, p: tuple[Tree, ...], double: Tree, trees: dict[str, Tree]) -> Mat3:
    """R(p) / p'p, each entry shared."""
    w, x, y, z = p
    entries = (
        (_one(double, y, z), _two(double, x, y, w, z, -1), _two(double, x, z, w, y, 1)),
        (_two(double, x, y, w, z, 1), _one(double, x, z), _two(double, y, z, w, x, -1)),
        (_two(double, x, z, w, y, -1), _two(double, y, z, w, x, 1), _one(double, x, y)),
    )
    first, second, third = (
        _shared(f"{name}#turn{number}", row, trees) for number, row in enumerate(entries, start=1)
    )
    return first, second, third


def _one(double: Tree, a: Tree, b: Tree) -> Tree:
    return less(ONE, times(double, plus(square(a), square(b))))


def _two(double: Tree, a: Tree, b: Tree, c: Tree, d: Tree, sign: int) -> Tree:
    second = times(c, d)
    return times(double, plus(times(a, b), second if sign > 0 else minus(second)))


def _shared(prefix: str, vector: Vec3, trees: dict[str, Tree]) -> Vec3:
    names = Name(f"{prefix}x"), Name(f"{prefix}y"), Name(f"{prefix}z")
    trees |= {name.name: tree for name, tree in zip(names, vector, strict=True)}
    return names


def norm_rows(prefix: str, step: Step) -> dict[str, Tree]:
    """What a quaternion's norm is held by: ``g = (p'p - 1) / 2`` and its two derivatives.

    It says nothing about the motion (see above).
    """
    seconds = plus(*(times(Name(one), Name(derivative(one, 2))) for one in step.coordinates))
    rates = plus(*(square(Name(derivative(one))) for one in step.coordinates))
    size = plus(*(square(Name(one)) for one in step.coordinates))
    held = f"{prefix}#norm"
    return {
        held: times(Number(0.5), less(size, ONE)),
        derivative(held): _along(step),
        derivative(held, 2): plus(seconds, rates),
    }


def back(turn: Turn, vector: Vec3) -> Vec3:
    """A vector of the frame before the step in the axes after it."""
    return vector if turn.rows is None else _applied(columns(turn.rows), vector)


def forth(turn: Turn, vector: Vec3) -> Vec3:
    """A vector of the frame after the step in the axes before it."""
    return vector if turn.rows is None else _applied(turn.rows, vector)


def _applied(rows: Mat3, a: Vec3) -> Vec3:
    x, y, z = (plus(*(times(m, v) for m, v in zip(row, a, strict=True))) for row in rows)
    return x, y, z


def combined(turn: Turn, swept: Vec3) -> Vec3:
    """What the step adds to the angular acceleration: its own, and ``swept`` x spin.

    ``swept`` is the parent's angular velocity in the axes after the step.
    """
    return total(turn.spinning, cross(swept, turn.spin))
