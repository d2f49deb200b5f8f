"""One equation of motion for every state or coordinate, and for nothing else."""

from collections.abc import Iterator, Mapping

from schemas.errors import Issue
from schemas.expressions import derivative, names_in, split
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.suggest import did_you_mean
from schemas.systems import Ode, SecondOrder


def check(problem: Problem) -> Iterator[Issue]:
    """States without a derivative, accelerations without a coordinate, residuals of any number."""
    for index, phase in enumerate(problem.phases):
        system, root = phase.system, ("phases", index, "system")
        if isinstance(system, Ode):
            place = (*root, "derivatives")
            yield from _matched("derivative", "state", system.states, system.derivatives, place)
        elif isinstance(system, SecondOrder):
            names, given = system.coordinates, system.accelerations
            if given is not None:
                place = (*root, "accelerations")
                yield from _matched("acceleration", "coordinate", names, given, place)
            elif len(system.residual or []) != len(names):
                count = len(system.residual or [])
                yield Issue(
                    pointer(*root, "residual"),
                    f"{count} residuals for {len(names)} coordinates",
                    "give one equation of motion for every coordinate",
                )
            else:
                yield from _without_acceleration(system, root)


def _without_acceleration(system: SecondOrder, root: tuple[Part, ...]) -> Iterator[Issue]:
    """Coordinates whose accelerations no residual depends on: nothing would give them."""
    used: set[str] = set()
    trees = {name: expression.tree for name, expression in system.define.items()}
    ahead = [expression.tree for expression in system.residual or []]
    while ahead:
        new = {name.name for name in names_in(ahead.pop())} - used
        used |= new
        ahead += [trees[split(name).base] for name in new if split(name).base in trees]
        if any(split(name).order and split(name).base in trees for name in new):
            return  # a derivative of an intermediate may bring in any acceleration
    for name in system.coordinates:
        if not any(split(word).base == name and split(word).order >= 2 for word in used):
            yield Issue(
                pointer(*root, "residual"),
                f"no residual depends on the acceleration {derivative(name, 2)}",
                "write the equations of motion; what holds without accelerations is a constraint "
                "in 'path'",
            )


def _matched(
    equation: str,
    kind: str,
    names: list[str],
    given: Mapping[str, object],
    root: tuple[Part, ...],
) -> Iterator[Issue]:
    without = [name for name in dict.fromkeys(names) if name not in given]
    for name in without:
        yield Issue(
            pointer(*root, name),
            f"the {equation} of the {kind} '{name}' is missing",
            f'write "{name}": "..."',
        )
    for name in given:
        if name not in names:
            yield Issue(
                pointer(*root, name),
                f"'{name}' is not a {kind}",
                did_you_mean(name, without)
                or _mend(f"{kind}s without a {equation}", kind, without),
            )


def _mend(lonely: str, kind: str, without: list[str]) -> str:
    if without:
        return f"the {lonely} are " + ", ".join(without)
    return f"add it to '{kind}s', or take it away"
