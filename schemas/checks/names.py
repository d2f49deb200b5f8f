"""Names: none reserved, none given twice."""

from collections.abc import Iterator

from schemas.errors import Issue
from schemas.expressions import FUNCTIONS
from schemas.expressions.tokens import REFUSED_WORDS
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem

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
    """Declared names are free to take, and taken once; so are the constraints' names."""
    for index, phase in enumerate(problem.phases):
        root = ("phases", index)
        yield from _reserved([(phase.name, "a phase", (*root, "name"))])
        yield from _reserved(declared(phase, root))
        yield from _repeated(declared(phase, root))
        yield from _repeated(_constraints(phase, root))


def declared(phase: Phase, root: tuple[Part, ...]) -> Iterator[_Declared]:
    """Every name that the phase declares, what it is, and where."""
    system = phase.system
    for kind, field, names in (
        ("a state", "states", system.states),
        ("a control", "controls", system.controls),
    ):
        for index, name in enumerate(names):
            yield name, kind, (*root, "system", field, index)
    for name in system.parameters:
        yield name, "a parameter", (*root, "system", "parameters", name)
    for name in system.define:
        yield name, "an intermediate", (*root, "system", "define", name)
    for name in phase.integrals:
        yield name, "an integral", (*root, "integrals", name)


def _constraints(phase: Phase, root: tuple[Part, ...]) -> Iterator[_Declared]:
    for field in ("path", "boundary"):
        for index, constraint in enumerate(getattr(phase, field)):
            yield constraint.name, f"a {field} constraint", (*root, field, index, "name")


def _reserved(names: Iterator[_Declared] | list[_Declared]) -> Iterator[Issue]:
    for name, kind, parts in names:
        if name in RESERVED:
            yield Issue(
                pointer(*parts),
                f"'{name}' is reserved and cannot name {kind}",
                f"take another name, such as '{name}_1'",
            )


def _repeated(names: Iterator[_Declared]) -> Iterator[Issue]:
    taken: dict[str, str] = {}
    for name, kind, parts in names:
        if name in taken:
            yield Issue(pointer(*parts), f"'{name}' is already the name of {taken[name]}")
        taken.setdefault(name, kind)
