"""A mechanism's constants have values, its masses are above zero, its directions have lengths."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from schemas.checks.constants import Constants
from schemas.errors import Issue
from schemas.expressions import Expression, ExpressionError, constant, names_in
from schemas.mechanisms import Body, Mechanism, Prismatic
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem

_HEAVY = 'every moving part needs both: "mass" in kg, "inertia" in kg m^2 about its com'


def check(problem: Problem) -> Iterator[Issue]:
    """Numbers of bodies and directions; those of drives and contacts are other checks'."""
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            numbers = Numbers.of(phase, index)
            yield from _finite(phase.system, numbers)
            yield from _bodies(phase.system, numbers)
            yield from _joints(phase.system, numbers)


@dataclass(frozen=True, slots=True)
class Numbers:
    """Values of a mechanism's constants; None where they are not known before the solve."""

    known: Mapping[str, float]
    root: tuple[Part, ...]

    @classmethod
    def of(cls, phase: Phase, index: int) -> "Numbers":
        """Over the phase's parameters; the check of limits reports those that have no value."""
        root: tuple[Part, ...] = ("phases", index)
        return cls(Constants.of(phase, root).known, (*root, "system"))

    def value(self, expression: Expression | None) -> float | None:
        """The number, where it has one."""
        try:
            return None if expression is None else constant(expression.tree, self.known)
        except ExpressionError:
            return None

    def at(self, *parts: Part) -> str:
        """A pointer into the mechanism."""
        return pointer(*self.root, *parts)


def _finite(system: Mechanism, numbers: Numbers) -> Iterator[Issue]:
    """Constants of known names that have no value all the same."""
    for parts, expression in system.constants():
        if all(name.name in numbers.known for name in names_in(expression.tree)):
            try:
                constant(expression.tree, numbers.known)
            except ExpressionError as error:
                yield Issue(numbers.at(*parts), error.message, error.hint, error.column)


def _bodies(system: Mechanism, numbers: Numbers) -> Iterator[Issue]:
    parents = {link.parent for link in system.links}
    for name, body in system.bodies.items():
        for field in ("mass", "inertia"):
            value = numbers.value(getattr(body, field))
            if value is not None and value <= 0 and not (field == "inertia" and value == 0):
                yield Issue(
                    numbers.at("bodies", name, field),
                    f"the {field} of '{name}' is {value:g}, and must be above 0",
                    "leave mass and inertia out for a mere frame between two joints",
                )
        yield from _halves(name, body, numbers)
        if body.mass is None and body.inertia is None and name not in parents:
            yield Issue(
                numbers.at("bodies", name),
                f"'{name}' has no mass and carries none: nothing would give its acceleration",
                _HEAVY,
            )


def _halves(name: str, body: Body, numbers: Numbers) -> Iterator[Issue]:
    if (body.mass is None) != (body.inertia is None):
        given, missing = ("mass", "inertia") if body.inertia is None else ("inertia", "mass")
        yield Issue(
            numbers.at("bodies", name, missing),
            f"'{name}' has a {given} but no {missing}".replace("a inertia", "an inertia"),
            f'{_HEAVY}; of a point mass it is "inertia": 0',
        )


def _joints(system: Mechanism, numbers: Numbers) -> Iterator[Issue]:
    for name, joint in system.joints.items():
        if isinstance(joint, Prismatic):
            yield from _direction(joint.axis, numbers, ("joints", name, "axis"))
    for name, force in system.forces.items():
        yield from _direction(force.direction, numbers, ("forces", name, "direction"))


def _direction(
    pair: list[Expression], numbers: Numbers, parts: tuple[Part, ...]
) -> Iterator[Issue]:
    if [numbers.value(one) for one in pair] == [0, 0]:
        message = f"the {parts[-1]} has no length"
        yield Issue(numbers.at(*parts), message, "along x it is [1, 0], along y [0, 1]")
