"""Where a mechanism touches: friction, restitution, circles, and grounds that do not step."""

from collections.abc import Iterator

from schemas.checks.heights import check_height, of_place
from schemas.checks.masses import Numbers
from schemas.errors import Issue
from schemas.mechanisms import Mechanism, Pair, Shape, Surface
from schemas.pointers import Part, pointer
from schemas.problem import Problem

_KINKS = ("abs", "max", "min")
_SMOOTH = (
    "write it smooth: sqrt(x^2 + 1e-4) for abs(x), (x + sqrt(x^2 + 1e-4))/2 for max(x, 0); the "
    "method 'time_stepping' of simulations takes kinks"
)


def check(problem: Problem) -> Iterator[Issue]:
    """Numbers of contacts, surfaces, shapes and pairs; heights that jump."""
    for index, phase in enumerate(problem.phases):
        if not isinstance(phase.system, Mechanism):
            continue
        numbers, system = Numbers.of(phase, index), phase.system
        for name, contact in system.contacts.items():
            radius = numbers.value(contact.radius)
            if radius is not None and radius < 0:
                where = numbers.at("contacts", name, "radius")
                yield Issue(where, "a radius below 0", "0 is a point")
        for name, surface in system.surfaces.items():
            yield from _rubbing("surfaces", name, surface, numbers)
            yield from check_height(surface.height, numbers.at("surfaces", name, "height"), numbers)
        for name in _held(system):
            yield from kinked(name, system.surfaces[name], numbers.root)
        for name, pair in (system.pairs or {}).items():
            yield from _rubbing("pairs", name, pair, numbers)
            yield from _own(name, pair, system, numbers)
        for name, shape in system.shapes.items():
            yield from _shape(name, shape, numbers)


def _rubbing(field: str, name: str, part: Surface | Pair, numbers: Numbers) -> Iterator[Issue]:
    friction, restitution = numbers.value(part.friction), numbers.value(part.restitution)
    if friction is not None and friction < 0:
        where = numbers.at(field, name, "friction")
        yield Issue(where, "a coefficient of friction below 0", "0 is without friction")
    if restitution is not None and not 0 <= restitution <= 1:
        yield Issue(
            numbers.at(field, name, "restitution"),
            f"a coefficient of restitution of {restitution:g}",
            "it is from 0, where nothing bounces, to 1, where no energy is lost",
        )


def _own(name: str, pair: Pair, system: Mechanism, numbers: Numbers) -> Iterator[Issue]:
    """A contact does not touch a shape of its own body."""
    contact, shape = system.contacts.get(pair.contact), system.shapes.get(pair.against)
    if contact is not None and shape is not None and contact.body == shape.body:
        yield Issue(
            numbers.at("pairs", name),
            f"'{pair.contact}' and '{pair.against}' are of the same body",
            "a pair is of two bodies that move against each other",
        )


def _shape(name: str, shape: Shape, numbers: Numbers) -> Iterator[Issue]:
    sizes = [("circle", shape.circle)] if shape.circle is not None else []
    for field, expression in sizes:
        value = numbers.value(expression)
        if value is not None and value <= 0:
            where = numbers.at("shapes", name, field)
            yield Issue(where, "a radius must be above 0", "touch a point by a 'contact' of it")
    for side, half in enumerate(shape.ellipse or []):
        value = numbers.value(half)
        if value is not None and value <= 0:
            yield Issue(numbers.at("shapes", name, "ellipse", side), "a half axis must be above 0")


def kinked(name: str, surface: Surface, root: tuple[Part, ...]) -> Iterator[Issue]:
    """An issue where the slope of a surface may jump, of which ``root`` is the mechanism's place.

    Contacts that are held by their accelerations follow slopes: a jump of one loses them.
    """
    call = of_place(surface.height.tree, _KINKS)
    if call is not None:
        message = f"with {call.function} the ground has a kink; what touches it is lost there"
        where = pointer(*root, "surfaces", name, "height")
        yield Issue(where, message, _SMOOTH, call.column)


def _held(system: Mechanism) -> list[str]:
    """The surfaces that contacts of the mode touch."""
    touching = system.touching
    found = {touching[pair].against for pair in system.mode if pair in touching}
    return [name for name in system.surfaces if name in found]
