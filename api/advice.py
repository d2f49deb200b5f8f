"""What a good problem's author may still want to know; part of ``?validate_only=true``."""

from collections.abc import Iterator

from schemas.expressions import Expression, warnings_in
from schemas.phases import Phase
from schemas.problem import Limits, Problem


def warnings(problem: Problem, limits: Limits) -> list[str]:
    """Notes on limits that the service lowers to ``limits``, and on expressions with corners."""
    lowered = [
        f"/limits/{name}: {getattr(problem.limits, name):g} becomes {getattr(limits, name):g}, "
        "the most this service gives"
        for name in Limits.model_fields
        if getattr(limits, name) < getattr(problem.limits, name)
    ]
    return lowered + [
        f"{pointer}: {note}"
        for pointer, expression in _expressions(problem)
        for note in warnings_in(expression.tree)
    ]


def _expressions(problem: Problem) -> Iterator[tuple[str, Expression]]:
    for index, phase in enumerate(problem.phases):
        yield from _of_phase(f"/phases/{index}", phase)
    if problem.objective is not None:
        yield "/objective/minimize", problem.objective.minimize


def _of_phase(base: str, phase: Phase) -> Iterator[tuple[str, Expression]]:
    named = {
        "system/define": phase.system.define,
        "system/derivatives": phase.system.derivatives,
        "integrals": phase.integrals,
    }
    for part, expressions in named.items():
        for name, expression in expressions.items():
            yield f"{base}/{part}/{name}", expression
    for part, constraints in {"path": phase.path, "boundary": phase.boundary}.items():
        for index, constraint in enumerate(constraints):
            yield f"{base}/{part}/{index}/expression", constraint.expression
