"""Names and ends of phases that are stepped through contact: no accelerations, in reach in time."""

import math
from collections.abc import Iterator, Sequence

from schemas.checks.chains import Chains, Node, written
from schemas.checks.constants import Constants, Interval
from schemas.checks.lengths import lengths
from schemas.errors import Issue
from schemas.expressions import Expression, derivative, names_in
from schemas.expressions.names import MAX_ORDER
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit, ContactImplicitPolished, Method
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.urdf import Urdf

_FORCES = ("normal", "tangential")
_SLACK = 1e-9


def check(problem: Problem, indices: Sequence[int]) -> Iterator[Issue]:
    """Of some phases."""
    names, lasting = written(problem), list(lengths(problem))
    for index in indices:
        phase, longest = problem.phases[index], lasting[index]
        if not isinstance(phase.system, Mechanism | Urdf):
            continue
        for node, (parts, column) in names[index].items():
            steep = _too_high(phase.system, node)
            if steep is not None:
                yield Issue(pointer(*parts), *_told(node, steep), column)
        if longest is not None and math.isfinite(longest[1]):
            yield from _out_of_reach(phase, index, longest[1])
        if _steps(phase.method or problem.method) == "pairwise":
            yield from _timed(phase, index)


def _steps(method: Method) -> str | None:
    chosen = method.steps if isinstance(method, ContactImplicitPolished) else method
    return chosen.steps if isinstance(chosen, ContactImplicit) else None


def _timed(phase: Phase, index: int) -> Iterator[Issue]:
    """Steps of their own lengths are solved on the clock of the mesh."""
    places: list[tuple[tuple[Part, ...], Expression]] = [
        *((("path", row, "expression"), one.expression) for row, one in enumerate(phase.path)),
        *((("integrals", name), one) for name, one in phase.integrals.items()),
        *((("system", "define", name), one) for name, one in phase.system.define.items()),
        *((("system", *parts), one) for parts, _, one in phase.system.equations()),
    ]
    for parts, expression in places:
        if any(name.name == "t" for name in names_in(expression.tree)):
            yield Issue(
                pointer("phases", index, *parts),
                "expressions over the time t have no value where steps share the time of pairs",
                "let 'steps' be 'duration' or 'fixed'",
            )


def _too_high(system: Mechanism | Urdf, root: Node) -> Node | None:
    """What a name is made of that time steps do not have: accelerations, rates of forces."""
    chains, pending, seen = Chains(system, native=True), [root], {root}
    while pending:
        node = pending.pop()
        if node.base not in system.define:
            if node.order > _most(system, node.base):
                return node
            continue
        for one in chains.made_of(node):
            if one not in seen:
                seen.add(one)
                pending.append(one)
    return None


def _most(system: Mechanism | Urdf, base: str) -> int:
    """The highest derivative that a step has: velocities of places, values of forces."""
    if base in system.coordinates:
        return 1
    if base in system.control_names or base.startswith(("motor.", "loop.")):
        return 0
    if base not in system.defined:
        return MAX_ORDER  # a constant, or a name that another check refuses
    if base.rpartition(".")[2].startswith(_FORCES):
        return 0
    return max(1 - (MAX_ORDER - system.defined[base]), 0)


def _told(root: Node, steep: Node) -> tuple[str, str]:
    needs = "" if root == steep else f" needs {steep}, and that"
    reason = "velocities jump at impacts, and forces are constant in a step"
    return f"{root}{needs} has no value here: {reason}", "use places, velocities and forces"


def _out_of_reach(phase: Phase, index: int, longest: float) -> Iterator[Issue]:
    """Coordinates that their velocity's bounds do not bring from start to end in time."""
    constants = Constants.of(phase, ("phases", index))

    def limits(field: str, name: str) -> Interval:
        bound = getattr(phase, field).get(name)
        found = None if bound is None else constants.interval(bound, ())
        return found or (-math.inf, math.inf)

    for name in phase.system.state_names[: len(phase.system.state_names) // 2]:
        start, end = limits("initial", name), limits("final", name)
        slowest, fastest = limits("bounds", derivative(name))
        for way, speed in ((end[0] - start[1], fastest), (start[0] - end[1], -slowest)):
            reach = max(speed, 0.0) * longest
            if way > reach + _SLACK * (1 + abs(way)):
                yield Issue(
                    pointer("phases", index, "final", name),
                    f"'{name}' has to go {way:.4g}, and within the bounds of {derivative(name)} "
                    f"it goes {reach:.4g} in {longest:g} s, which is all the time there is",
                    "give the phase more time, or wider bounds",
                )
