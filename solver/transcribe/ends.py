"""What is asked of the ends: each phase's own constraints, linkages, the objective."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.model import Constraint, Interval, Model
from solver.model.shape import ModelShape
from solver.nlp.stages import Rows, StageGroup
from solver.nlp.variables import Array, Variables
from solver.trajectory import Trajectory
from solver.transcribe.integrals import guessed_integrals
from solver.transcribe.junction import EndShape, Junction, Side, junction_of
from solver.transcribe.layout import PhaseLayout
from solver.transcribe.segments import limit_magnitude
from solver.transcribe.stage import functions_of

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
class _Inputs:
    """Symbols and the variables that they are, at ``columns``; constants and their ``values``."""

    variables: SX
    columns: Sequence[int]
    constants: SX
    values: Sequence[float]


@dataclass(frozen=True, slots=True)
class _Row:
    """A constraint over ends in symbols; ``fraction`` says where it lies, NaN for both ends."""

    name: str
    value: SX
    limits: Interval
    fraction: float = math.nan


@dataclass(frozen=True, slots=True)
class Ending:
    """Joins the ends of phases that are laid out; adds lifted integrals to ``variables``.

    ``constants`` are those of objective and linkages, ``statics`` the values to start from.
    """

    model: Model
    shape: ModelShape
    constants: Sequence[float]
    layouts: Sequence[PhaseLayout]
    variables: Variables

    def join(self, guesses: Sequence[Trajectory], statics: Sequence[float]) -> Joint:
        """Build the groups."""
        own = [self._own_unknowns(*each) for each in enumerate(self.layouts)]
        junction = self._junction([len(columns) for columns in own])
        sides = [_inputs(*each) for each in zip(self.layouts, junction.sides, own, strict=True)]
        values = [*(value for side in sides for value in side.values), *self.constants]
        use = junction.integrals.use(values)
        phases = self.model.phases
        named = [(name, index) for index, phase in enumerate(phases) for name in phase.integrals]
        lifted = tuple(named[place] for place in use.lifted)
        places = self._lift(lifted, guesses, statics)
        totals = _Inputs(junction.totals, places, SX(0, 1), ())
        groups = []
        for index, (layout, side) in enumerate(zip(self.layouts, sides, strict=True)):
            symbols = junction.sides[index]
            shared = _Inputs(symbols.shared.symbols, layout.shared().columns.tolist(), SX(0, 1), ())
            if rows := _rows(layout, symbols, len(own[index])):
                none = SX(1 + len(lifted), 1)
                groups.append(_group(index, [side, shared, totals], rows, none))
        sums = ca.vertcat(junction.objective, -junction.totals)
        joint = _Inputs(SX(0, 1), (), junction.constants, self.constants)
        known = [*sides, self._once(junction), totals, joint]
        groups.append(_group(None, known, self._linkages(junction), sums))
        return Joint((*groups,), use.weights([len(phase.integrals) for phase in phases]), lifted)

    def _own_unknowns(self, index: int, layout: PhaseLayout) -> list[int]:
        """Unknowns at the phase's start where the method has none there: else they were guessed.

        They start from those of the next node.
        """
        (strip, segment), _ = layout.ends()
        names = layout.phase.form.algebraic
        whole = layout.transcription
        if whole.shares_controls or whole.eliminates or not names:
            return []
        beside = strip.blocks["algebraic"][1][: len(names), segment]
        guess, scale = (self.variables.gather(name)[beside] for name in ("guess", "scale"))
        open_sides = (np.full((1, 1), -np.inf), np.full((1, 1), np.inf))
        block = self.variables.add(index, names, np.zeros(1), open_sides, guess[:, None], scale)
        return [int(place) for place in block[:, 0]]

    def _junction(self, unknowns: Sequence[int]) -> Junction:
        numbers: dict[int, int] = {}
        ends, stages = [], []
        for layout, count in zip(self.layouts, unknowns, strict=True):
            strips = [strip for strip, _ in layout.ends()]
            first, last = (layout.stage_shape(strip) for strip in strips)
            columns = layout.shared().columns.tolist()
            shared = tuple(numbers.setdefault(column, len(numbers)) for column in columns)
            ends.append(EndShape(first, last, count, shared))
            stages.append((layout.stage(strips[0]), layout.stage(strips[1])))
        return junction_of(self.shape, tuple(ends), stages)

    def _once(self, junction: Junction) -> _Inputs:
        """Times and statics of all phases, each once."""
        found: dict[int, SX] = {}
        for layout, side in zip(self.layouts, junction.sides, strict=True):
            for i, column in enumerate(layout.shared().columns.tolist()):
                found.setdefault(column, side.shared.symbols[i])
        return _Inputs(ca.vertcat(SX(0, 1), *found.values()), list(found), SX(0, 1), ())

    def _linkages(self, junction: Junction) -> list[_Row]:
        return [
            _row(linkage, junction.linkages[i]) for i, linkage in enumerate(self.model.linkages)
        ]

    def _lift(
        self,
        lifted: Sequence[tuple[str, int]],
        guesses: Sequence[Trajectory],
        statics: Sequence[float],
    ) -> list[int]:
        """Variables for lifted integrals."""
        start = {
            index: dict(
                zip(
                    self.model.phases[index].integrals,
                    self._guessed(index, guesses[index], statics),
                    strict=True,
                )
            )
            for index in {index for _, index in lifted}
        }
        return [
            _variable(self.variables, name, index, float(start[index][name]))
            for name, index in lifted
        ]

    def _guessed(self, index: int, guess: Trajectory, statics: Sequence[float]) -> Array:
        layout = self.layouts[index]
        functions = functions_of(layout.shape, eliminate=layout.transcription.eliminates)
        return guessed_integrals(layout.phase, functions, guess, [*statics, *layout.constants])


def _inputs(layout: PhaseLayout, side: Side, unknowns: Sequence[int]) -> _Inputs:
    """The end segments' variables, and the constants of these."""
    ends = layout.ends()
    columns = [column for strip, at in ends for column in strip.columns()[:, at].tolist()]
    places = [place for strip, at in ends for place in strip.places[:, at].tolist()]
    values = [*places, *layout.shared().values.tolist()]
    return _Inputs(side.variables, [*columns, *unknowns], side.constants, values)


def _group(
    phase: int | None, known: Sequence[_Inputs], rows: Sequence[_Row], sums: SX
) -> StageGroup:
    columns = [column for one in known for column in one.columns]
    values = [value for one in known for value in one.values]
    return StageGroup(
        phase=phase,
        variables=ca.vertcat(*(one.variables for one in known)),
        constants=ca.vertcat(*(one.constants for one in known)),
        columns=np.array(columns, dtype=int)[:, None],
        data=np.array(values, dtype=float)[:, None],
        rows=_stacked(rows),
        sums=sums,
    )


def _row(row: Constraint, value: SX) -> _Row:
    return _Row(row.label, value, row.limits)


def _rows(layout: PhaseLayout, side: Side, unknowns: int) -> list[_Row]:
    rows = [_row(row, side.boundary[i]) for i, row in enumerate(layout.phase.boundary)]
    if (limits := _duration(layout)) is not None:
        rows.append(_Row("duration", side.duration, limits))
    return [*rows, *_at_start(layout, side, unknowns)]


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


def _at_start(layout: PhaseLayout, side: Side, unknowns: int) -> list[_Row]:
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
        for i, row in enumerate([*phase.path, *phase.held[:unknowns]])
        if i >= len(phase.path) or not row.limits.fixed
    ]
    return [*controls, *path]


def _variable(variables: Variables, name: str, phase: int, guess: float) -> int:
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
        np.array([row.fraction for row in rows]).reshape(len(rows), 1),
    )
