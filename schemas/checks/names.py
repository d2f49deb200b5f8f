"""Names: none reserved, none given twice."""

from collections.abc import Iterable, Iterator
from itertools import chain

from schemas.errors import Issue
from schemas.expressions import FUNCTIONS
from schemas.expressions.tokens import REFUSED_WORDS
from schemas.mechanisms import Mechanism
from schemas.phases import Constraint, Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm, SecondOrder, System
from schemas.urdf import Urdf

RESERVED = frozenset(
    {
        *("t", "pi", "initial", "final", "duration", "com", "contact", "motor", "energy"),
        *FUNCTIONS,
        *REFUSED_WORDS,
    }
)
"""Names that no declaration may take."""

_Declared = tuple[str, str, tuple[Part, ...]]


def check(problem: Problem) -> Iterator[Issue]:
    """Declared names are free to take, and taken once; so are those of phases and constraints."""
    statics = [(name, "a static parameter", ("static", name)) for name in problem.static]
    yield from _reserved(statics)
    phases = [
        (phase.name, "a phase", ("phases", index, "name"))
        for index, phase in enumerate(problem.phases)
    ]
    yield from _reserved(phases)
    yield from _repeated(phases)
    for index, phase in enumerate(problem.phases):
        root = ("phases", index)
        own = list(declared(phase, root))
        yield from _reserved(own)
        yield from _repeated(chain(statics, own))
        yield from _repeated(
            chain(
                _constraints(phase.path, "a path constraint", (*root, "path")),
                _constraints(phase.boundary, "a boundary constraint", (*root, "boundary")),
            )
        )
    yield from _repeated(_constraints(problem.linkages, "a linkage", ("linkages",)))


def declared(phase: Phase, root: tuple[Part, ...]) -> Iterator[_Declared]:
    """Every name that the phase declares, what it is, and where."""
    yield from _varying(phase.system, (*root, "system"))
    for name in phase.system.parameters:
        yield name, "a parameter", (*root, "system", "parameters", name)
    for name in phase.system.define:
        yield name, "an intermediate", (*root, "system", "define", name)
    for name in phase.integrals:
        yield name, "an integral", (*root, "integrals", name)


def _varying(system: System, root: tuple[Part, ...]) -> Iterator[_Declared]:
    if isinstance(system, ClosedForm):
        for name in system.states:
            yield name, "a state", (*root, "states", name)
        return
    if isinstance(system, Mechanism):
        yield from _of_mechanism(system, root)
        return
    if isinstance(system, Urdf):
        for name in system.coordinates:
            yield name, "a joint", (*root, "text")
        for index, name in enumerate(system.controls):
            yield name, "a control", (*root, "controls", index)
        return
    field, kind, names = "states", "a state", system.state_names
    if isinstance(system, SecondOrder):
        field, kind, names = "coordinates", "a coordinate", system.coordinates
    for index, name in enumerate(names):
        yield name, kind, (*root, field, index)
    for index, name in enumerate(system.controls):
        yield name, "a control", (*root, "controls", index)


def _of_mechanism(system: Mechanism, root: tuple[Part, ...]) -> Iterator[_Declared]:
    """Joints, whose coordinates bear their names, and the user's own controls."""
    for name in system.joints:
        yield name, "a joint", (*root, "joints", name)
    for index, name in enumerate(system.controls):
        yield name, "a control", (*root, "controls", index)


def _constraints(
    constraints: list[Constraint], kind: str, root: tuple[Part, ...]
) -> Iterator[_Declared]:
    for index, constraint in enumerate(constraints):
        yield constraint.name, kind, (*root, index, "name")


def _reserved(names: Iterable[_Declared]) -> Iterator[Issue]:
    for name, kind, parts in names:
        if name in RESERVED:
            yield Issue(
                pointer(*parts),
                f"'{name}' is reserved and cannot name {kind}",
                f"take another name, such as '{name}_1'",
            )


def _repeated(names: Iterable[_Declared]) -> Iterator[Issue]:
    taken: dict[str, str] = {}
    for name, kind, parts in names:
        if name in taken:
            yield Issue(
                pointer(*parts),
                f"'{name}' is already the name of {taken[name]}",
                "give each its own name",
            )
        taken.setdefault(name, kind)
