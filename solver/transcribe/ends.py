"""What joins the ends of all phases: boundary constraints and the objective, in one stage."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX, evaluate
from solver.model import Interval, Model
from solver.model.symbolic import Ends, PhaseFunctions, boundary_scope, objective_scope
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Variables
from solver.trajectory import Trajectory
from solver.transcribe.integrals import classify, guessed_integrals
from solver.transcribe.layout import PhaseLayout
from solver.transcribe.segments import limit_magnitude, symbolic_stage
from solver.transcriptions.base import Transcription

_SHORTEST = 1e-6  # s: a phase of free times keeps its direction


@dataclass(frozen=True, slots=True)
class Joint:
    """The group of the ends, and what each phase's integrals add to the program's sums.

    ``weights`` has one array (sums, integrals) per phase; ``lifted`` names the lifted integrals.
    """

    group: StageGroup
    weights: list[Array]
    lifted: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _PhaseEnds:
    """One phase's ends: symbols, which of them are variables, and where these stand."""

    ends: Ends
    variables: SX
    columns: list[int]


@dataclass(frozen=True, slots=True)
class _Row:
    """A boundary constraint in symbols."""

    name: str
    value: SX
    limits: Interval


def join_ends(
    model: Model,
    layouts: Sequence[PhaseLayout],
    transcription: Transcription,
    functions: Sequence[PhaseFunctions],
    guesses: Sequence[Trajectory],
    variables: Variables,
) -> Joint:
    """Build the group; lifted integrals are added to ``variables``."""
    sides = [
        _phase_ends(layout, transcription, own)
        for layout, own in zip(layouts, functions, strict=True)
    ]
    pairs = list(zip(layouts, sides, strict=True))
    scopes = [boundary_scope(layout.phase, side.ends) for layout, side in pairs]
    rows = [
        row
        for (layout, side), scope in zip(pairs, scopes, strict=True)
        for row in _rows(layout, side.ends, scope)
    ]
    objective = _objective(model, scopes)
    integrals = ca.vertcat(SX(0, 1), *(side.ends.integrals for side in sides))
    use = classify(objective, ca.vertcat(SX(0, 1), *(row.value for row in rows)), integrals)

    names = [(index, name) for index, phase in enumerate(model.phases) for name in phase.integrals]
    start = np.concatenate(
        [guessed_integrals(*pair) for pair in zip(functions, guesses, strict=True)]
    )
    lifted_columns = [
        _lift(variables, *names[position], float(start[position])) for position in use.lifted
    ]
    direct, lifted = (_pick(integrals, which) for which in (use.direct, use.lifted))
    group = StageGroup(
        phase=None,
        variables=ca.vertcat(*(side.variables for side in sides), lifted),
        constants=SX(0, 1),
        columns=np.array(
            [*(column for side in sides for column in side.columns), *lifted_columns], dtype=int
        )[:, None],
        data=np.empty((0, 1)),
        rows=_stacked(rows),
        sums=ca.vertcat(ca.substitute(objective, direct, SX.zeros(*direct.shape)), -lifted),
    )
    weights = use.weights([len(phase.integrals) for phase in model.phases])
    return Joint(group, weights, tuple(names[position][1] for position in use.lifted))


def _phase_ends(
    layout: PhaseLayout, transcription: Transcription, functions: PhaseFunctions
) -> _PhaseEnds:
    """The ends as the transcription completes them, over all variables of both end segments."""
    times, knots, columns = layout.time_symbols(), layout.mesh.knots, layout.segment_columns()
    first, last = (
        symbolic_stage(layout, times, SX([start, end - start]), transcription, functions)
        for start, end in (knots[:2], knots[-2:])
    )
    points = first.collocation.points[0], last.collocation.points[-1]
    ends = Ends(
        x=(points[0].x, points[1].x),
        u=(points[0].u, points[1].u),
        t=(times.start, times.end),
        integrals=SX.sym("integral", len(layout.phase.integrals)),
    )
    where = [*columns[:, 0].tolist(), *columns[:, -1].tolist(), *layout.free_times()]
    return _PhaseEnds(ends, ca.vertcat(first.own, last.own, times.free), where)


def _pick(symbols: SX, positions: Sequence[int]) -> SX:
    return ca.vertcat(SX(0, 1), *(symbols[i] for i in positions))


def _objective(model: Model, scopes: Sequence[Mapping[str, SX]]) -> SX:
    if model.objective is None:
        return SX(0)
    return evaluate(model.objective, objective_scope(model, scopes))


def _rows(layout: PhaseLayout, ends: Ends, scope: Mapping[str, SX]) -> list[_Row]:
    phase = layout.phase
    rows = [
        _Row(f"boundary {row.name}", evaluate(row.tree, scope), row.limits)
        for row in phase.boundary
    ]
    if phase.end.lower <= phase.start.upper:
        limits = Interval(_SHORTEST, float("inf"))
        rows.append(_Row("positive duration", ends.t[1] - ends.t[0], limits))
    return [*rows, *_initial_controls(layout, ends)]


def _initial_controls(layout: PhaseLayout, ends: Ends) -> list[_Row]:
    """Limits of controls at the start where the method has no variable there."""
    phase = layout.phase
    if len(layout.controls[0]):
        return []
    return [
        _Row(f"initial {name}", ends.u[0][i], phase.initial[name])
        for i, name in enumerate(phase.controls)
        if np.any(np.isfinite(phase.initial[name]))
    ]


def _lift(variables: Variables, phase: int, name: str, guess: float) -> int:
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
