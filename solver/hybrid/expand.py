"""The problem that is solved in place of the posted one: modes as phases, periods as linkages."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from schemas.expressions import Call, Expression, Name, Number
from schemas.mechanisms import Mechanism, Mode
from schemas.methods import Hybrid, HybridMode
from schemas.periodic import Impact, Periodic
from schemas.phases import Phase
from schemas.problem import Objective, Problem, Static
from schemas.stepped import stepped_by
from solver.hybrid.modes import durations, mode_phases, part_names
from solver.hybrid.passages import Joined, Passage, Touchdown, chained, join
from solver.lowering.uses import used_series
from solver.poses.loose import COST
from solver.switches.rename import renamed_linkages, renamed_objective, whole_rows


@dataclass(frozen=True, slots=True)
class Split:
    """A posted phase as its modes: their phases' names, and shares of the guessed time."""

    phase: Phase
    names: tuple[str, ...]
    shares: tuple[float, ...]
    modes: tuple[HybridMode, ...]


@dataclass(frozen=True, slots=True)
class Expansion:
    """The problem to solve, and how its phases came about: None for those that are as posted."""

    problem: Problem
    splits: tuple[Split | None, ...]


def expand(problem: Problem) -> Expansion:
    """Modes of hybrid phases become phases PHASE/MODE, periodic ones get their linkages.

    What the user says of a phase's ends holds for the first mode's start and the last mode's end;
    integrals are summed over the modes. A problem without either comes back as it is.
    """
    splits = tuple(_split(problem, phase) for phase in problem.phases)
    if not any(splits) and all(phase.periodic is None for phase in problem.phases):
        return Expansion(problem, splits)
    parts = {one.phase.name: one.names for one in splits if one is not None}
    joined = [
        join(passage, passage.system.state_names)
        for index in range(len(splits))
        for passage in _passages(problem, index, splits[index])
    ]
    rows = [
        row
        for phase, one in zip(problem.phases, splits, strict=True)
        if one is not None
        for row in whole_rows(problem, phase, one.names)
    ]
    changed = {
        "phases": [
            part
            for phase, one in zip(problem.phases, splits, strict=True)
            for part in _parts(problem, phase, one)
        ],
        "linkages": [
            *renamed_linkages(problem, parts),
            *rows,
            *(row for one in joined for row in one.linkages),
        ],
        "objective": _objective(problem, parts, [name for one in joined for name in one.loose]),
        "static": {**problem.static, **_statics(joined)},
    }
    return Expansion(problem.model_copy(update=changed), splits)


def _objective(
    problem: Problem, parts: Mapping[str, Sequence[str]], loose: Sequence[str]
) -> Objective | None:
    """The posted one over the modes, and a small cost of impulses that nothing else settles."""
    objective = renamed_objective(problem, parts)
    if not loose:
        return objective
    costs = [Call("*", (Number(COST), Call("^", (Name(name), Number(2.0))))) for name in loose]
    terms = [*([objective.minimize.tree] if objective else []), *costs]
    text = objective.minimize.text if objective else "0"
    return Objective.model_construct(minimize=Expression(text, Call("+", tuple(terms))))


def _statics(joined: Sequence[Joined]) -> dict[str, Static]:
    return {name: static for one in joined for name, static in one.statics.items()}


def _split(problem: Problem, phase: Phase) -> Split | None:
    method = phase.method or problem.method
    if not isinstance(method, Hybrid) or not isinstance(phase.system, Mechanism):
        return None
    names = tuple(part_names(phase, method))
    return Split(phase, names, tuple(durations(phase, method)), tuple(method.sequence))


def _parts(problem: Problem, phase: Phase, split: Split | None) -> list[Phase]:
    method = phase.method or problem.method
    if stepped_by(problem, phase) is not None:  # its first step looks back at the last one
        return [phase]
    if split is None or not isinstance(method, Hybrid) or not isinstance(phase.system, Mechanism):
        return [phase.model_copy(update={"periodic": None})]
    return mode_phases(phase, phase.system, method, split.shares)


def _passages(problem: Problem, index: int, split: Split | None) -> Iterator[Passage]:
    phase = problem.phases[index]
    chain = chained(used_series(problem, index), phase)
    names = (phase.name,) if split is None else split.names
    modes = () if split is None else split.modes
    for (one, two), (before, after) in zip(pairwise(names), pairwise(modes), strict=False):
        touchdown = _between(before, after)
        yield Passage(
            one, two, phase.system, touchdown=touchdown, chain=chain, statics=problem.static
        )
    if phase.periodic is not None:
        yield Passage(
            names[-1],
            names[0],
            phase.system,
            phase.periodic,
            _around(phase.periodic, modes[0].contacts if modes else _mode(phase)),
            chain,
            problem.static,
        )


def _mode(phase: Phase) -> Mapping[str, Mode]:
    """What touches all along a phase that has no sequence."""
    return phase.system.mode if isinstance(phase.system, Mechanism) else {}


def _between(before: HybridMode, after: HybridMode) -> Touchdown | None:
    """The impact between two modes: where a contact begins to touch."""
    lands = [name for name in after.contacts if name not in before.contacts]
    leaves = [name for name in before.contacts if name not in after.contacts]
    return Touchdown(after.contacts, lands, leaves) if lands else None


def _around(periodic: Periodic, first: Mapping[str, Mode]) -> Touchdown | None:
    """The impact at the end of a period, its contacts called as before the exchange.

    ``first`` is what touches at the start; where nothing does, what lands sticks for an instant.
    """
    impact: Impact | None = periodic.impact
    if impact is None:
        return None
    after: dict[str, Mode] = {periodic.swapped(name): mode for name, mode in first.items()}
    return Touchdown(after or dict.fromkeys(impact.lands, "sticking"), impact.lands, impact.leaves)
