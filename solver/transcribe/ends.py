"""What is asked of the ends: each phase's own constraints, linkages, the objective."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from solver.expressions import SX, evaluate
from solver.model import Constraint, Interval, Model
from solver.model.symbolic import Ends, PhaseFunctions, boundary_scope, objective_scope
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Variables
from solver.trajectory import Trajectory
from solver.transcribe.integrals import classify, guessed_integrals
from solver.transcribe.layout import PhaseLayout, Shared, TimeSymbols
from solver.transcribe.segments import limit_magnitude, symbolic_stage

_SHORTEST = 1e-6  # s: a phase of free times keeps its direction


@dataclass(frozen=True, slots=True)
class Joint:
    """The groups of the ends, and what each phase's integrals add to the program's sums.

    ``weights`` has one array (sums, integrals) per phase; ``lifted`` has name and phase of each
    lifted integral.
    """

    groups: tuple[StageGroup, ...]
    weights: list[Array]
    lifted: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class _Known:
    """Symbols (n,), and where the variables stand that they are, (n,)."""

    symbols: SX
    columns: list[int]


@dataclass(frozen=True, slots=True)
class _PhaseEnds:
    """One phase's ends, and the variables of their segments.

    ``path`` has the values at the start of the constraints along the phase, (rows,); ``unknowns``
    counts the unknowns that have variables of their own there.
    """

    ends: Ends
    known: _Known
    path: SX
    unknowns: int


@dataclass(frozen=True, slots=True)
class _Row:
    """A constraint over ends in symbols; ``fraction`` says where it lies, NaN for both ends."""

    name: str
    value: SX
    limits: Interval
    fraction: float = math.nan


def join_ends(
    model: Model,
    layouts: Sequence[PhaseLayout],
    functions: Sequence[PhaseFunctions],
    guesses: Sequence[Trajectory],
    statics: Sequence[float],
    variables: Variables,
) -> Joint:
    """Build the groups; lifted integrals are added to ``variables``."""
    shared = _one_of_each([layout.shared() for layout in layouts])
    sides = [
        _phase_ends(index, *each, variables)
        for index, each in enumerate(zip(layouts, shared, functions, strict=True))
    ]
    names = [static.name for static in model.statics]
    scopes = [
        boundary_scope(layout.phase, side.ends, names, eliminate=layout.transcription.eliminates)
        for layout, side in zip(layouts, sides, strict=True)
    ]
    own = [_rows(*each) for each in zip(layouts, sides, scopes, strict=True)]
    whole = objective_scope(model, scopes, shared[0].statics)
    links = [_row(linkage, whole) for linkage in model.linkages]
    objective = SX(0) if model.objective is None else evaluate(model.objective, whole)
    integrals = ca.vertcat(SX(0, 1), *(side.ends.integrals for side in sides))
    use = classify(objective, _values([row for rows in (*own, links) for row in rows]), integrals)

    named = [(name, index) for index, phase in enumerate(model.phases) for name in phase.integrals]
    lifted = tuple(named[place] for place in use.lifted)
    start = np.concatenate(
        [
            guessed_integrals(*each, statics)
            for each in zip(model.phases, functions, guesses, strict=True)
        ]
    )
    places = [_lift(variables, *named[place], float(start[place])) for place in use.lifted]
    totals = _Known(_pick(integrals, use.lifted), places)
    groups = [
        _group(index, [side.known, _once([times]), totals], rows, SX(1 + len(lifted), 1))
        for index, (side, times, rows) in enumerate(zip(sides, shared, own, strict=True))
        if rows
    ]
    direct = _pick(integrals, use.direct)
    sums = ca.vertcat(ca.substitute(objective, direct, SX.zeros(*direct.shape)), -totals.symbols)
    known = [*(side.known for side in sides), _once(shared), totals]
    weights = use.weights([len(phase.integrals) for phase in model.phases])
    return Joint((*groups, _group(None, known, links, sums)), weights, lifted)


def _group(
    phase: int | None, known: Sequence[_Known], rows: Sequence[_Row], sums: SX
) -> StageGroup:
    columns = [column for one in known for column in one.columns]
    return StageGroup(
        phase=phase,
        variables=ca.vertcat(*(one.symbols for one in known)),
        constants=SX(0, 1),
        columns=np.array(columns, dtype=int)[:, None],
        data=np.empty((0, 1)),
        rows=_stacked(rows),
        sums=sums,
    )


def _one_of_each(shared: Sequence[Shared]) -> list[Shared]:
    """The same with one symbol for each variable, over all phases."""
    symbols: dict[int, SX] = {}
    unified = []
    for one in shared:
        own = [symbols.setdefault(column, one.symbols[i]) for i, column in enumerate(one.columns)]
        fresh = ca.vertcat(SX(0, 1), *own)
        start, end, statics = ca.substitute(
            [one.times.start, one.times.end, one.statics], [one.symbols], [fresh]
        )
        unified.append(Shared(TimeSymbols(start, end), statics, fresh, one.columns))
    return unified


def _once(shared: Sequence[Shared]) -> _Known:
    """Times and statics, each once."""
    found = {int(column): one.symbols[i] for one in shared for i, column in enumerate(one.columns)}
    return _Known(ca.vertcat(SX(0, 1), *found.values()), list(found))


def _phase_ends(
    index: int,
    layout: PhaseLayout,
    shared: Shared,
    functions: PhaseFunctions,
    variables: Variables,
) -> _PhaseEnds:
    """The ends as the transcription completes them, over all variables of both end segments."""
    sides = [
        (
            symbolic_stage(strip, shared, SX(strip.places[:, segment]), functions),
            strip.columns()[:, segment].tolist(),
        )
        for strip, segment in layout.ends()
    ]
    (first, columns), (last, more) = sides
    start, own = first.collocation.points[0], _own_unknowns(index, layout, variables)
    count = len(own.columns)
    rest = _pick(start.z, range(count, start.z.numel()))
    start = replace(start, z=ca.vertcat(own.symbols, rest))
    ends = Ends(
        initial=first.place(start),
        final=last.place(last.collocation.points[-1]),
        integrals=SX.sym("integral", len(layout.phase.integrals)),
    )
    known = _Known(ca.vertcat(first.own, last.own, own.symbols), [*columns, *more, *own.columns])
    return _PhaseEnds(ends, known, first.at(functions.path, start), count)


def _own_unknowns(index: int, layout: PhaseLayout, variables: Variables) -> _Known:
    """Unknowns at the phase's start where the method has none there: else they were guessed.

    They start from those of the next node.
    """
    (strip, segment), _ = layout.ends()
    names = layout.phase.form.algebraic
    if layout.transcription.shares_controls or layout.transcription.eliminates or not names:
        return _Known(SX(0, 1), [])
    beside = strip.blocks["algebraic"][1][: len(names), segment]
    guess, scale = (variables.gather(name)[beside] for name in ("guess", "scale"))
    open_sides = (np.full((1, 1), -np.inf), np.full((1, 1), np.inf))
    block = variables.add(index, names, np.zeros(1), open_sides, guess[:, None], scale)
    return _Known(SX.sym("unknown", len(names)), block[:, 0].tolist())


def _pick(symbols: SX, positions: Sequence[int]) -> SX:
    return ca.vertcat(SX(0, 1), *(symbols[i] for i in positions))


def _values(rows: Sequence[_Row]) -> SX:
    return ca.vertcat(SX(0, 1), *(row.value for row in rows))


def _row(row: Constraint, scope: Mapping[str, SX]) -> _Row:
    return _Row(row.label, evaluate(row.tree, scope), row.limits)


def _rows(layout: PhaseLayout, side: _PhaseEnds, scope: Mapping[str, SX]) -> list[_Row]:
    rows = [_row(row, scope) for row in layout.phase.boundary]
    if (limits := _duration(layout)) is not None:
        rows.append(_Row("duration", side.ends.final.t - side.ends.initial.t, limits))
    return [*rows, *_at_start(layout, side)]


def _duration(layout: PhaseLayout) -> Interval | None:
    """The limits of the duration that those of the times do not imply."""
    start, end, (least, most) = layout.start, layout.end, layout.phase.duration
    if end.index is None and start.index is None:
        return None
    if start.index is None and end.limits.lower >= start.limits.lower + _SHORTEST:
        return None  # the duration's limits are in the end's
    if end.limits.lower > start.limits.upper and not layout.phase.duration.finite:
        return None
    return Interval(max(least, _SHORTEST), max(most, _SHORTEST))


def _at_start(layout: PhaseLayout, side: _PhaseEnds) -> list[_Row]:
    """Limits at the start of controls and path, where the method has no control there.

    Bounds that hold all along are in the method's hull already. Equalities along the path are left
    out: at the other nodes they settle the control's polynomial.
    """
    phase = layout.phase
    if layout.transcription.shares_controls:
        return []
    controls = [
        _Row(f"initial {name}", side.ends.initial.u[i], phase.initial[name], 0.0)
        for i, name in enumerate(phase.controls)
        if phase.initial[name] != phase.bounds[name]
    ]
    path = [
        _Row(row.label, side.path[i], row.limits, 0.0)
        for i, row in enumerate([*phase.path, *phase.held[: side.unknowns]])
        if i >= len(phase.path) or not row.limits.fixed
    ]
    return [*controls, *path]


def _lift(variables: Variables, name: str, phase: int, guess: float) -> int:
    open_sides = (np.full((1, 1), -np.inf), np.full((1, 1), np.inf))
    scale, start = np.array([max(1.0, abs(guess))]), np.full((1, 1), guess)
    block = variables.add(
        phase, (f"integral {name}",), np.array([np.nan]), open_sides, start, scale
    )
    return int(block[0, 0])


def _stacked(rows: Sequence[_Row]) -> Rows:
    return Rows(
        _values(rows),
        tuple(row.name for row in rows),
        np.array([row.limits.lower for row in rows]),
        np.array([row.limits.upper for row in rows]),
        np.array([limit_magnitude(row.limits) for row in rows]),
        np.array([row.fraction for row in rows]).reshape(len(rows), 1),
    )
