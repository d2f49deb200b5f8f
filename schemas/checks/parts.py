"""The parts of a mechanism name each other rightly, and have names of their own."""

from collections.abc import Collection, Iterator

from schemas.errors import Issue
from schemas.mechanisms import (
    GROUND,
    Floating,
    Mechanism,
    Place,
    Prismatic,
    Revolute,
    Shape,
    Welded,
)
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean

TAKEN = frozenset({"com", "energy", "motor", "spring", "contact", "loop", "initial", "final"})
"""What stands before a dot already."""

Use = tuple[tuple[Part, ...], str, str, Collection[str]]
"""Where a name is used, the name, what it should be, and those that there are."""


def check(problem: Problem) -> Iterator[Issue]:
    """Unknown bodies, joints, contacts, surfaces; names that two parts would share."""
    yield from shared(problem)
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            root = ("phases", index, "system")
            yield from _missing(_uses(phase.system), root)
            yield from _alone(phase.system, root)


def unjoined(problem: Problem) -> Iterator[Issue]:
    """Joints of bodies that are not there, and bodies that are called the ground."""
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            root = ("phases", index, "system")
            if GROUND in phase.system.bodies:
                yield _reserved(GROUND, "a body", pointer(*root, "bodies", GROUND))
            yield from _missing(_joined(phase.system), root)


def shared(problem: Problem) -> Iterator[Issue]:
    """Names that are reserved, or that two parts of a mechanism would have."""
    phases = {phase.name for phase in problem.phases}
    for index, phase in enumerate(problem.phases):
        if isinstance(phase.system, Mechanism):
            yield from _shared(phase.system, ("phases", index, "system"), phases)


def _reserved(name: str, kind: str, where: str) -> Issue:
    message = f"'{name}' is reserved and cannot name {kind}"
    return Issue(where, message, f"take another name, such as '{name}_1'")


def _missing(uses: Iterator[Use], root: tuple[Part, ...]) -> Iterator[Issue]:
    for parts, name, what, known in uses:
        if name not in known:
            some = ", ".join(list(known)[:12])
            hint = did_you_mean(name, known)
            hint = hint or (f"known here: {some}" if some else f"there is no {what} at all")
            yield Issue(pointer(*root, *parts), f"there is no {what} '{name}'", hint)


def _uses(system: Mechanism) -> Iterator[Use]:
    yield from _bodies(system)
    moving = [n for n, one in system.joints.items() if isinstance(one, Revolute | Prismatic)]
    fixed = [n for n, one in system.joints.items() if isinstance(one, Welded | Floating)]
    for field in ("motors", "springs", "torques"):
        for name, part in getattr(system, field).items():
            if part.joint is not None and part.joint not in fixed:
                yield (field, name, "joint"), part.joint, "joint", moving
    against = [*system.surfaces, *system.shapes]
    for name, pair in (system.pairs or {}).items():
        yield ("pairs", name, "contact"), pair.contact, "contact", system.contacts
        yield ("pairs", name, "against"), pair.against, "surface or shape", against
    for name in system.mode:
        yield ("mode", name), name, "pair", system.touching
    held = [f"contact.{name}.normal" for name in system.mode]
    held += [f"contact.{n}.tangential" for n, mode in system.mode.items() if mode == "sticking"]
    held += [f"loop.{name}.{side}" for name in system.loops for side in ("x", "y")]
    for index, name in enumerate(system.loose):
        yield ("loose", index), name, "force that holds something", held


def _joined(system: Mechanism) -> Iterator[Use]:
    """The bodies of each joint."""
    bodies, places = list(system.bodies), [*system.bodies, GROUND]
    for name, joint in system.joints.items():
        if not isinstance(joint, Floating):
            yield ("joints", name, "parent"), joint.parent, "body", places
        if joint.child != GROUND:
            yield ("joints", name, "child"), joint.child, "body", bodies


def _bodies(system: Mechanism) -> Iterator[Use]:
    """Every place that names a body, but those of joints: `unjoined` has looked at them."""
    bodies, places = list(system.bodies), [*system.bodies, GROUND]
    for parts, place in _places(system):
        yield (*parts, "body"), place.body, "body", places
    for field in ("forces", "torques"):
        for name, part in getattr(system, field).items():
            if part.body is not None:
                yield (field, name, "body"), part.body, "body", bodies


def _places(system: Mechanism) -> Iterator[tuple[tuple[Part, ...], Place | Shape]]:
    for field in ("points", "contacts", "shapes"):
        for name, place in getattr(system, field).items():
            yield (field, name), place
    for field in ("loops", "springs"):
        for name, part in getattr(system, field).items():
            for side, place in enumerate(part.between or []):
                yield (field, name, "between", side), place


def _alone(system: Mechanism, root: tuple[Part, ...]) -> Iterator[Issue]:
    """Loops and springs from a body to itself."""
    for field in ("loops", "springs"):
        for name, part in getattr(system, field).items():
            if part.between and part.between[0].body == part.between[1].body:
                yield Issue(
                    pointer(*root, field, name, "between"),
                    f"both places are of '{part.between[0].body}', which is rigid",
                    "name places of two bodies",
                )


def _shared(system: Mechanism, root: tuple[Part, ...], phases: set[str]) -> Iterator[Issue]:
    """Bodies, points and contacts stand before a dot: each needs a word of its own."""
    seen: dict[str, str] = {}
    for field, kind in (("bodies", "a body"), ("points", "a point"), ("contacts", "a contact")):
        for name in getattr(system, field):
            where = pointer(*root, field, name)
            if name in TAKEN or name == GROUND:
                yield _reserved(name, kind, where)
            elif name in phases:
                message = f"'{name}' is already the name of a phase"
                yield Issue(where, message, f"'{name}.x' would mean two things: rename one")
            elif name in seen:
                message = f"'{name}' is already the name of {seen[name]}"
                yield Issue(where, message, f"'{name}.x' would mean two things: rename one")
            seen.setdefault(name, kind)
    for name in system.shapes:
        if name in system.surfaces:
            message = f"'{name}' is already the name of a surface"
            yield Issue(pointer(*root, "shapes", name), message, "give each its own name")
    if system.pairs is None and len(system.touching) < len(system.contacts) * len(system.surfaces):
        message = "two pairs of contact and surface would have the same name"
        yield Issue(pointer(*root, "contacts"), message, "name them in 'pairs'")
