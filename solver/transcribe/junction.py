"""What is asked of the ends, in symbols: made once for all problems of one shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from solver.expressions import SX, scalars
from solver.model.shape import ModelShape, PhaseShape
from solver.model.slots import valued
from solver.model.symbolic import Ends, Place, boundary_scope, objective_scope
from solver.nlp.kept import Kept
from solver.transcribe.integrals import Sorted, classify
from solver.transcribe.stage import SharedSymbols, Stage, StageShape, shared_symbols

_ROOM = 500_000  # nodes of expressions


@dataclass(frozen=True, slots=True)
class EndShape:
    """Of one phase: its end segments, and how many unknowns have variables at its start.

    ``shared`` numbers the variables of its free times and statics: those that are the same in
    other phases have the same number.
    """

    first: StageShape
    last: StageShape
    unknowns: int
    shared: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Side:
    """One phase's ends in symbols.

    Attributes
    ----------
    variables
        Those of the first segment, of the last one, and unknowns at the start.
    places
        Both segments' places in the phase, as a stage has them, (6,).
    ends
        The ends as the transcription completes them.
    duration
        The length of the phase.
    path
        The constraints along the phase at its start, (rows,); nothing where a knot has them.
    boundary
        The phase's constraints over its ends, (rows,).
    """

    variables: SX
    places: SX
    shared: SharedSymbols
    ends: Ends
    duration: SX
    path: SX
    boundary: SX

    @property
    def constants(self) -> SX:
        """Places, then what the phase shares."""
        return ca.vertcat(self.places, self.shared.constants)


@dataclass(frozen=True, slots=True)
class Junction:
    """All phases' ends, and what joins them.

    ``objective`` is what is left of it without the integrals that are added up in place;
    ``totals`` are those that are lifted; ``constants`` belong to objective and linkages.
    """

    sides: tuple[Side, ...]
    linkages: SX
    objective: SX
    totals: SX
    constants: SX
    integrals: Sorted


def junction_of(
    shape: ModelShape, ends: tuple[EndShape, ...], stages: Sequence[tuple[Stage, Stage]]
) -> Junction:
    """The junction of a shape, kept from the last one of the same shape."""
    return _JUNCTIONS.get((shape, ends), lambda: _made(shape, ends, stages))


def _made(
    shape: ModelShape, ends: Sequence[EndShape], stages: Sequence[tuple[Stage, Stage]]
) -> Junction:
    symbols: dict[int, SX] = {}
    for number in (number for one in ends for number in one.shared):
        symbols.setdefault(number, SX.sym("shared"))
    sides, scopes = [], []
    for phase, one, pair in zip(shape.phases, ends, stages, strict=True):
        own = ca.vertcat(SX(0, 1), *(symbols[number] for number in one.shared))
        side = _side(phase, one, pair, own)
        scope = boundary_scope(phase, side.ends, eliminate=one.first.eliminates)
        constants = scalars(side.shared.p)[len(phase.statics) :]
        rows = [valued(row, scope, constants) for row in phase.boundary]
        sides.append(replace(side, boundary=ca.vertcat(SX(0, 1), *rows)))
        scopes.append(scope)
    joint = SX.sym("c", shape.constants)
    slots = scalars(joint)
    statics = sides[0].shared.p[: len(shape.statics)]
    whole = objective_scope(shape, scopes, statics)
    links = ca.vertcat(SX(0, 1), *(valued(row, whole, slots) for row in shape.linkages))
    objective = valued(shape.objective, whole, slots)
    integrals = ca.vertcat(SX(0, 1), *(side.ends.integrals for side in sides))
    asked = ca.vertcat(links, *(side.boundary for side in sides))
    numbers = ca.vertcat(*(side.constants for side in sides), joint)
    found = classify(objective, asked, integrals, numbers)
    direct = _pick(integrals, found.direct)
    rest = ca.substitute(objective, direct, SX.zeros(*direct.shape))
    return Junction(tuple(sides), links, rest, _pick(integrals, found.lifted), joint, found)


def _side(shape: PhaseShape, one: EndShape, pair: tuple[Stage, Stage], symbols: SX) -> Side:
    shared, places = shared_symbols(shape, one.first.times, symbols), SX.sym("place", 6)
    both = [SX.sym("own", stage.own.numel()) for stage in pair]
    halves = ca.vertsplit(places, 3)
    points = [
        stage.ends()(own, shared.symbols, place, shared.constants)
        for stage, own, place in zip(pair, both, halves, strict=True)
    ]
    unknown = SX.sym("unknown", one.unknowns)
    x, u, z, natives = (SX(part) for part in points[0][:4])
    rest = ca.vertsplit(z, [0, one.unknowns, z.numel()])[1]
    initial = Place(x, u, ca.vertcat(unknown, rest), natives, shared.times.start, shared.p)
    last = [SX(part) for part in points[1][4:]]
    final = Place(last[0], last[1], last[2], last[3], shared.times.end, shared.p)
    ends = Ends(initial, final, SX.sym("integral", len(shape.integrals)))
    path = SX(0, 1)
    if not one.first.shares_controls:
        path = SX(pair[0].functions.path(*initial.arguments()))
    duration = shared.times.end - shared.times.start
    return Side(ca.vertcat(*both, unknown), places, shared, ends, duration, path, SX(0, 1))


def _pick(symbols: SX, positions: Sequence[int]) -> SX:
    return ca.vertcat(SX(0, 1), *(symbols[i] for i in positions))


def _length(junction: Junction) -> int:
    parts = [junction.linkages, junction.objective]
    parts += [side.boundary for side in junction.sides]
    return int(ca.n_nodes(ca.vertcat(*parts)))


_JUNCTIONS: Kept[Junction] = Kept(_ROOM, _length)
