"""A motion in closed form starts where its phase starts."""

from collections.abc import Iterator, Mapping

from schemas.errors import Issue
from schemas.expressions import Expression, ExpressionError, constant, names_in
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.resolve import parameters
from schemas.systems import ClosedForm

_TRIES = 3
_CLOSE = 1e-6


def check(problem: Problem) -> Iterator[Issue]:
    """At ``t = initial.t`` every formula gives its own ``initial.NAME``, for any values of them."""
    for index, phase in enumerate(problem.phases):
        system = phase.system
        if not isinstance(system, ClosedForm):
            continue
        for name in system.states:
            if any(_starts_elsewhere(name, start) for start in _starts(problem, system)):
                yield Issue(
                    pointer("phases", index, "system", "states", name),
                    f"at the start of the phase this does not give initial.{name}",
                    f"write it as initial.{name} + ... with the rest 0 at t = initial.t",
                )


def _starts(problem: Problem, system: ClosedForm) -> Iterator[Mapping[str, float]]:
    """What the formulas give at the start, beside the values that they started from.

    Values that cannot be computed are left out: other checks tell what is wrong with them.
    """
    names = [*(f"initial.{name}" for name in system.states), *problem.static]
    for attempt in range(_TRIES):
        time = 0.25 * attempt
        spread = (0.5 + 0.618034 * (count + 1) * (attempt + 1) % 1 for count in range(len(names)))
        values = dict(zip(names, spread, strict=True)) | {"t": time, "initial.t": time}
        try:
            values |= parameters(system)
        except ExpressionError:
            return
        _evaluate(system.define, values)
        _evaluate(system.states, values)
        yield values


def _evaluate(formulas: Mapping[str, Expression], values: dict[str, float]) -> None:
    for name, formula in formulas.items():
        if all(used.name in values for used in names_in(formula.tree)):
            try:
                values[name] = constant(formula.tree, values)
            except ExpressionError:
                continue


def _starts_elsewhere(name: str, values: Mapping[str, float]) -> bool:
    start = values[f"initial.{name}"]
    return abs(values.get(name, start) - start) > _CLOSE
