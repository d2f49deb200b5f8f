"""Contacts and loops at the ends of phases: what is to be asked for, and what leaves no room.

Where a phase goes on from another one's end, what held there still holds; asked for once more, it
would be an equality that others imply, and nonlinear ones cannot be told by a Jacobian. So names
that linkages carry over are followed, and what is held is compared in numbers: at random places,
the one row over the values that the other one sees.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from schemas.expressions import Call, Name, Tree
from schemas.phases import Constraint
from schemas.problem import Problem
from solver.lowering import Form
from solver.numeric import Array, along

Flags = NDArray[np.bool_]

_PLACES = 3
_SAME = 1e-9


@dataclass(slots=True)
class Implied:
    """Of one phase.

    Attributes
    ----------
    starts
        Definitions that have to be zero at its start.
    settled
        Names of path constraints that are equalities by themselves -> at which fractions of the
        phase, 0 or 1.
    idle
        Names of those that are so all along.
    """

    starts: tuple[str, ...] = ()
    settled: dict[str, set[float]] = field(default_factory=dict)
    idle: set[str] = field(default_factory=set)


@dataclass(frozen=True, slots=True)
class _Passage:
    """From the end of one phase to the start of another: names there -> names here."""

    before: int
    after: int
    names: Mapping[str, str]


def implied(problem: Problem, forms: Sequence[Form]) -> list[Implied]:
    """For each phase what its contacts and loops imply at its ends."""
    found = [Implied() for _ in forms]
    if not any(form.holonomic for form in forms):
        return found
    passages = list(_passages(problem))
    for index, (one, form) in enumerate(zip(found, forms, strict=True)):
        needed = _at_start(form)
        _settle(one, problem, form, index)
        for passage in passages:
            if passage.after == index and needed:
                needed = _not_held(problem, forms, passage, needed)
        one.starts = tuple(needed)
    for passage in passages:
        _settle_ends(problem, forms, passage, found)
    return found


def _at_start(form: Form) -> list[str]:
    """Anchored places and all rates; other places are wherever the phase starts."""
    places = [one.place for one in form.holonomic if one.place is not None and one.anchored]
    return [*places, *(one.rate for one in form.holonomic)]


def _held(form: Form) -> list[Tree]:
    return [Name(name) for name in _at_start(form)]


def _passages(problem: Problem) -> Iterator[_Passage]:
    """Where linkages, or a phase's own boundary, say that values at ends are equal."""
    order = {phase.name: index for index, phase in enumerate(problem.phases)}
    pairs: dict[tuple[int, int], dict[str, str]] = {}
    rows = [(row, "") for row in problem.linkages]
    rows += [(row, f"{phase.name}.") for phase in problem.phases for row in phase.boundary]
    for row, prefix in rows:
        for ends in _equal(row, prefix):
            (one, final), (two, initial) = ends
            if one in order and two in order:
                pairs.setdefault((order[one], order[two]), {})[initial] = final
    return (_Passage(*key, names) for key, names in pairs.items())


def _equal(row: Constraint, prefix: str) -> Iterator[tuple[tuple[str, str], tuple[str, str]]]:
    """Phase and name at its end, phase and name at its start, where a row says they are equal."""
    tree = row.expression.tree
    limits = {_number(row, "lower"), _number(row, "upper")}
    if not (isinstance(tree, Call) and tree.function == "-" and limits == {0.0}):
        return
    sides = [one.name for one in tree.arguments if isinstance(one, Name)]
    if len(sides) == 2:
        for a, b in (sides, sides[::-1]):
            before, final, name = f"{prefix}{a}".partition(".final.")
            after, initial, other = f"{prefix}{b}".partition(".initial.")
            if final and initial:
                yield (before, name), (after, other)


def _number(row: Constraint, side: str) -> float:
    value = getattr(row, side)
    return math.nan if value is None or not isinstance(value.source, float) else value.source


def _not_held(
    problem: Problem, forms: Sequence[Form], passage: _Passage, needed: Sequence[str]
) -> list[str]:
    """What the end of the phase before does not hold already."""
    ours = [Name(name) for name in needed]
    same = _coincide(problem, forms, passage, ours, _held(forms[passage.before]))
    return [name for name, row in zip(needed, np.any(same, axis=1), strict=True) if not row]


def _settle_ends(
    problem: Problem, forms: Sequence[Form], passage: _Passage, found: Sequence[Implied]
) -> None:
    """Inequalities at either end that the other side's contacts decide."""
    after = [row.expression.tree for row in problem.phases[passage.after].path]
    same = _coincide(problem, forms, passage, after, _held(forms[passage.before]))
    _note(found[passage.after], problem.phases[passage.after].path, np.any(same, axis=1), 0.0)
    before = [row.expression.tree for row in problem.phases[passage.before].path]
    same = _coincide(problem, forms, passage, _held(forms[passage.after]), before)
    _note(found[passage.before], problem.phases[passage.before].path, np.any(same, axis=0), 1.0)


def _settle(one: Implied, problem: Problem, form: Form, index: int) -> None:
    """Path constraints over what the phase itself holds."""
    path = problem.phases[index].path
    own = _Passage(index, index, {name: name for name in form.states})
    forms = {index: form}
    same = _coincide(problem, forms, own, [row.expression.tree for row in path], _held(form))
    one.idle |= {row.name for row, held in zip(path, np.any(same, axis=1), strict=True) if held}


def _note(one: Implied, path: Sequence[Constraint], which: Flags, where: float) -> None:
    for row, settled in zip(path, which, strict=True):
        if settled:
            one.settled.setdefault(row.name, set()).add(where)


def _coincide(
    problem: Problem,
    forms: Mapping[int, Form] | Sequence[Form],
    passage: _Passage,
    after: Sequence[Tree],
    before: Sequence[Tree],
) -> Flags:
    """Which rows of the later phase's start are rows of the earlier one's end, (after, before)."""
    none = np.zeros((len(after), len(before)), dtype=bool)
    if none.size == 0:
        return none
    rng = np.random.default_rng(0)
    early, late = forms[passage.before], forms[passage.after]
    given = dict.fromkeys(problem.static, 1.0)
    x = {name: rng.normal(size=_PLACES) for name in late.states}
    y = {name: rng.normal(size=_PLACES) for name in early.states}
    y |= {there: x[here] for here, there in passage.names.items() if here in x}
    ours, theirs = _values(late, after, x, given), _values(early, before, y, given)
    gaps = np.abs(ours[:, None] - theirs[None])
    return np.asarray(np.all(gaps <= _SAME * (1 + np.abs(theirs)), axis=2), dtype=bool)


@np.errstate(all="ignore")  # what has no value there is not the same
def _values(
    form: Form, trees: Sequence[Tree], x: Mapping[str, Array], given: Mapping[str, float]
) -> Array:
    """Values (trees, places); NaN for what depends on forces or accelerations."""
    states = np.array([x[name] for name in form.states])
    controls = np.random.default_rng(1).normal(size=(len(form.controls), _PLACES))
    ready = [along(form, [tree], given) for tree in trees]
    nothing = np.full((1, _PLACES), np.nan)
    time = np.zeros(_PLACES)
    return np.concatenate([nothing if one.solves else one(time, states, controls) for one in ready])
