"""The names that a problem uses of a phase outside of its system, at ends or along it."""

from collections.abc import Iterator

from schemas.expressions import Tree, names_in
from schemas.phases import Phase
from schemas.problem import Problem

_ENDS = ("initial", "final")


def used_series(problem: Problem, index: int) -> list[str]:
    """Series and intermediates of a phase that path, ends, integrals or objective ask for.

    Guesses ask for nothing: where a solve starts does not change what is solved.
    """
    phase = problem.phases[index]
    names = [*_along(phase), *_at_ends(problem, phase)]
    others = {"t", "duration", *phase.integrals}
    return [name for name in dict.fromkeys(names) if name not in others]


def _along(phase: Phase) -> Iterator[str]:
    for constraint in phase.path:
        yield from _names(constraint.expression.tree)
    for integrand in phase.integrals.values():
        yield from _names(integrand.tree)
    for limits in (phase.bounds, phase.initial, phase.final):
        yield from limits


def _at_ends(problem: Problem, phase: Phase) -> Iterator[str]:
    for constraint in phase.boundary:
        yield from _ends_of(constraint.expression.tree, _ENDS)
    own = [f"{phase.name}.{end}" for end in _ENDS]
    shared = (*_ENDS, *own) if len(problem.phases) == 1 else own
    for constraint in problem.linkages:
        yield from _ends_of(constraint.expression.tree, shared)
    if problem.objective is not None:
        yield from _ends_of(problem.objective.minimize.tree, shared)


def _ends_of(tree: Tree, prefixes: tuple[str, ...] | list[str]) -> Iterator[str]:
    for name in _names(tree):
        for prefix in prefixes:
            if name.startswith(f"{prefix}."):
                yield name[len(prefix) + 1 :]


def _names(tree: Tree) -> Iterator[str]:
    return (name.name for name in names_in(tree))
