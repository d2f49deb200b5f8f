"""One derivative for every state, and for nothing else."""

from collections.abc import Iterator

from schemas.errors import Issue
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean


def check(problem: Problem) -> Iterator[Issue]:
    """States without a derivative, derivatives without a state."""
    for index, phase in enumerate(problem.phases):
        states, given = phase.system.states, phase.system.derivatives
        place = ("phases", index, "system", "derivatives")
        for name in dict.fromkeys(states):
            if name not in given:
                yield Issue(
                    pointer(*place, name), f"the derivative of the state '{name}' is missing"
                )
        without = [name for name in states if name not in given]
        for name in given:
            if name not in states:
                hint = did_you_mean(name, without) or _mend(without)
                yield Issue(pointer(*place, name), f"'{name}' is not a state", hint)


def _mend(without: list[str]) -> str:
    if without:
        return "the states without a derivative are " + ", ".join(without)
    return "add it to 'states', or take it away"
