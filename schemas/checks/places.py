"""Where expressions stand in a problem, and which names each of them sees."""

from collections.abc import Iterator, Set
from dataclasses import dataclass

from schemas.expressions import Expression
from schemas.phases import Phase
from schemas.pointers import Part
from schemas.problem import Problem


@dataclass(frozen=True, slots=True)
class Place:
    """One expression: the way to it, and the names in its scope (valid until the next place)."""

    parts: tuple[Part, ...]
    expression: Expression
    visible: Set[str]
    phase: Phase | None


def places(problem: Problem) -> Iterator[Place]:
    """Every expression that is not a constant, in the order of the document."""
    for index, phase in enumerate(problem.phases):
        yield from _along(phase, ("phases", index))
        ends = at_ends(phase)
        for number, constraint in enumerate(phase.boundary):
            parts = ("phases", index, "boundary", number, "expression")
            yield Place(parts, constraint.expression, ends, phase)
    if problem.objective is not None:
        only = problem.phases[0] if len(problem.phases) == 1 else None
        scope = at_problem(problem)
        yield Place(("objective", "minimize"), problem.objective.minimize, scope, only)


def at_ends(phase: Phase) -> set[str]:
    """The names of a boundary constraint: ends, duration, integrals, parameters."""
    names = {f"{end}.{name}" for end in ("initial", "final") for name in ("t", *variables(phase))}
    return {"duration", *names, *phase.integrals, *phase.system.parameters}


def at_problem(problem: Problem) -> set[str]:
    """The names of the objective: those of every phase's ends, with and without the phase."""
    names = {f"{phase.name}.{name}" for phase in problem.phases for name in at_ends(phase)}
    return names | at_ends(problem.phases[0]) if len(problem.phases) == 1 else names


def variables(phase: Phase) -> list[str]:
    """States, then controls."""
    return [*phase.system.states, *phase.system.controls]


def _along(phase: Phase, root: tuple[Part, ...]) -> Iterator[Place]:
    system = phase.system
    seen = {"t", *variables(phase), *system.parameters}
    for name, expression in system.define.items():
        yield Place((*root, "system", "define", name), expression, seen, phase)
        seen.add(name)
    for name, expression in system.derivatives.items():
        yield Place((*root, "system", "derivatives", name), expression, seen, phase)
    for index, constraint in enumerate(phase.path):
        yield Place((*root, "path", index, "expression"), constraint.expression, seen, phase)
    for name, expression in phase.integrals.items():
        yield Place((*root, "integrals", name), expression, seen, phase)
