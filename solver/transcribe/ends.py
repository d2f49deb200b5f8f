"""What joins the ends of all phases, in one stage: constraints, linkages, the objective."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX, evaluate
from solver.model import Constraint, Interval, Model
from solver.model.symbolic import Ends, PhaseFunctions, Place, boundary_scope, objective_scope
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Variables
from solver.trajectory import Trajectory
from solver.transcribe.integrals import classify, guessed_integrals
from solver.transcribe.layout import PhaseLayout, Shared, TimeSymbols
from solver.transcribe.segments import limit_magnitude, symbolic_stage

_SHORTEST = 1e-6  # s: a phase of free times keeps its direction


@dataclass(frozen=True, slots=True)
class Joint:
    """The group of the ends, and what each phase's integrals add to the program's sums.

    ``weights`` has one array (sums, integrals) per phase; ``lifted`` has name and phase of each
    lifted integral.
    """

    group: StageGroup
    weights: list[Array]
    lifted: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class _PhaseEnds:
    """One phase's ends: symbols, which of them are variables, and where these stand."""

    ends: Ends
    variables: SX
    columns: list[int]


@dataclass(frozen=True, slots=True)
class _Row:
    """A constraint over ends in symbols."""

    name: str
    value: SX
    limits: Interval


def join_ends(
    model: Model,
    layouts: Sequence[PhaseLayout],
    functions: Sequence[PhaseFunctions],
    guesses: Sequence[Trajectory],
    statics: Sequence[float],
    variables: Variables,
) -> Joint:
    """Build the group; lifted integrals are added to ``variables``."""
    shared = _one_of_each([layout.shared() for layout in layouts])
    sides = [_phase_ends(*each) for each in zip(layouts, shared, functions, strict=True)]
    pairs = list(zip(layouts, sides, strict=True))
    names = [static.name for static in model.statics]
    scopes = [
        boundary_scope(layout.phase, side.ends, names, eliminate=layout.transcription.eliminates)
        for layout, side in pairs
    ]
    whole = objective_scope(model, scopes, shared[0].statics)
    rows = [
        row
        for (layout, side), scope in zip(pairs, scopes, strict=True)
        for row in _rows(layout, side.ends, scope)
    ]
    rows += [_row(linkage, whole) for linkage in model.linkages]
    objective = SX(0) if model.objective is None else evaluate(model.objective, whole)
    integrals = ca.vertcat(SX(0, 1), *(side.ends.integrals for side in sides))
    use = classify(objective, ca.vertcat(SX(0, 1), *(row.value for row in rows)), integrals)

    named = [(name, index) for index, phase in enumerate(model.phases) for name in phase.integrals]
    start = np.concatenate(
        [
            guessed_integrals(*each, statics)
            for each in zip(model.phases, functions, guesses, strict=True)
        ]
    )
    lifted_columns = [
        _lift(variables, *named[position], float(start[position])) for position in use.lifted
    ]
    direct, lifted = (_pick(integrals, which) for which in (use.direct, use.lifted))
    symbols, columns = _shared_variables(shared)
    group = StageGroup(
        phase=None,
        variables=ca.vertcat(*(side.variables for side in sides), symbols, lifted),
        constants=SX(0, 1),
        columns=np.array(
            [*(column for side in sides for column in side.columns), *columns, *lifted_columns],
            dtype=int,
        )[:, None],
        data=np.empty((0, 1)),
        rows=_stacked(rows),
        sums=ca.vertcat(ca.substitute(objective, direct, SX.zeros(*direct.shape)), -lifted),
    )
    weights = use.weights([len(phase.integrals) for phase in model.phases])
    return Joint(group, weights, tuple(named[position] for position in use.lifted))


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


def _shared_variables(shared: Sequence[Shared]) -> tuple[SX, list[int]]:
    """Times and statics, each once."""
    found = {int(column): one.symbols[i] for one in shared for i, column in enumerate(one.columns)}
    return ca.vertcat(SX(0, 1), *found.values()), list(found)


def _phase_ends(layout: PhaseLayout, shared: Shared, functions: PhaseFunctions) -> _PhaseEnds:
    """The ends as the transcription completes them, over all variables of both end segments."""
    sides = [
        (
            symbolic_stage(strip, shared, SX(strip.places[:, segment]), functions),
            strip.columns()[:, segment].tolist(),
        )
        for strip, segment in layout.ends()
    ]
    (first, columns), (last, more) = sides
    ends = Ends(
        initial=first.place(first.collocation.points[0]),
        final=last.place(last.collocation.points[-1]),
        integrals=SX.sym("integral", len(layout.phase.integrals)),
    )
    return _PhaseEnds(ends, ca.vertcat(first.own, last.own), [*columns, *more])


def _pick(symbols: SX, positions: Sequence[int]) -> SX:
    return ca.vertcat(SX(0, 1), *(symbols[i] for i in positions))


def _row(row: Constraint, scope: Mapping[str, SX]) -> _Row:
    return _Row(row.label, evaluate(row.tree, scope), row.limits)


def _rows(layout: PhaseLayout, ends: Ends, scope: Mapping[str, SX]) -> list[_Row]:
    rows = [_row(row, scope) for row in layout.phase.boundary]
    if (limits := _duration(layout)) is not None:
        rows.append(_Row("duration", ends.final.t - ends.initial.t, limits))
    return [*rows, *_initial_controls(layout, ends.initial)]


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


def _initial_controls(layout: PhaseLayout, initial: Place) -> list[_Row]:
    """Limits of controls at the start where the method has no variable there."""
    phase = layout.phase
    (strip, _), _ = layout.ends()
    if len(strip.blocks["control"][0]):
        return []
    return [
        _Row(f"initial {name}", initial.u[i], phase.initial[name])
        for i, name in enumerate(phase.controls)
        if phase.initial[name].finite
    ]


def _lift(variables: Variables, name: str, phase: int, guess: float) -> int:
    open_sides = (np.full((1, 1), -np.inf), np.full((1, 1), np.inf))
    scale, start = np.array([max(1.0, abs(guess))]), np.full((1, 1), guess)
    block = variables.add(
        phase, (f"integral {name}",), np.array([np.nan]), open_sides, start, scale
    )
    return int(block[0, 0])


def _stacked(rows: Sequence[_Row]) -> Rows:
    return Rows(
        ca.vertcat(SX(0, 1), *(row.value for row in rows)),
        tuple(row.name for row in rows),
        np.array([row.limits.lower for row in rows]),
        np.array([row.limits.upper for row in rows]),
        np.array([limit_magnitude(row.limits) for row in rows]),
        np.full((len(rows), 1), np.nan),
    )
