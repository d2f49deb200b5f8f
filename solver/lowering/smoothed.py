"""A problem with smooth functions in place of abs, min and max."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from pydantic import BaseModel

from schemas.expressions import Expression, Tree
from schemas.expressions.smoothing import SMOOTH, smooth
from schemas.phases import Phase
from schemas.problem import Problem, Smoothing


def smoothed(problem: Problem) -> Problem:
    """The problem that is solved in place of ``problem``: the same, unless it asks for smoothing.

    Trees alone change; texts stay the user's.
    """
    if problem.nonsmooth is None or not isinstance(problem.nonsmooth.abs, Smoothing):
        return problem
    absolute = _absolute(problem.nonsmooth.abs)
    constants = [f"{phase.name}.{name}" for phase in problem.phases for name in _fixed(phase)]
    if len(problem.phases) == 1:
        constants += _fixed(problem.phases[0])
    shared = ("objective", "linkages")
    changes = {
        name: _mapped(
            getattr(problem, name),
            partial(smooth, absolute=absolute, fixed=set(constants).__contains__),
        )
        for name in shared
    }
    phases = [
        _mapped(phase, partial(smooth, absolute=absolute, fixed=_fixed(phase).__contains__))
        for phase in problem.phases
    ]
    return problem.model_copy(update={**changes, "phases": phases})


def _fixed(phase: Phase) -> list[str]:
    return list(phase.system.parameters)


def _absolute(smoothing: Smoothing) -> Callable[[Tree, int], Tree]:
    kind = "tanh" if smoothing.tanh is not None else "sqrt"
    width = getattr(smoothing, kind)

    def absolute(tree: Tree, column: int) -> Tree:
        return SMOOTH[kind](tree, width, column)

    return absolute


def _mapped(value: Any, change: Callable[[Tree], Tree]) -> Any:
    """Any part of a problem with all its expressions changed, other than those of constants."""
    if isinstance(value, Expression):
        return replace(value, tree=change(value.tree))
    if isinstance(value, BaseModel):
        fields = {name: _mapped(getattr(value, name), change) for name in type(value).model_fields}
        return value.model_copy(update=fields)
    if isinstance(value, Mapping):
        return {name: _mapped(one, change) for name, one in value.items()}
    if isinstance(value, list):
        return [_mapped(one, change) for one in value]
    return value
