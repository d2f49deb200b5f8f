"""Which integrals matter: those that the objective or a constraint depends on."""

from collections.abc import Iterator

from schemas.expressions import Tree, names_in
from schemas.phases import Phase
from schemas.problem import Problem


def integrals_in(tree: Tree, problem: Problem, within: Phase | None) -> Iterator[tuple[str, str]]:
    """Phases and integrals that a tree uses; ``within`` is the phase in which it stands."""
    used = {name.name for name in names_in(tree)}
    for phase in problem.phases if within is None else [within]:
        bare = within is not None or len(problem.phases) == 1
        for name in phase.integrals:
            if f"{phase.name}.{name}" in used or (bare and name in used):
                yield phase.name, name


def used_integrals(problem: Problem, phase: Phase) -> tuple[str, ...]:
    """The integrals of a phase that the objective or a constraint depends on."""
    objective = [problem.objective.minimize.tree] if problem.objective else []
    joint = [*objective, *(row.expression.tree for row in problem.linkages)]
    own = [row.expression.tree for row in phase.boundary]
    pairs = [(tree, None) for tree in joint] + [(tree, phase) for tree in own]
    used = {pair for tree, within in pairs for pair in integrals_in(tree, problem, within)}
    return tuple(name for name in phase.integrals if (phase.name, name) in used)
