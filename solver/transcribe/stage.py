"""A segment in symbols, completed by the transcription: made once for all of one shape."""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

import casadi as ca
import numpy as np

from solver.expressions import SX
from solver.model.shape import PhaseShape
from solver.model.symbolic import PhaseFunctions, Place, phase_functions
from solver.nlp.kept import Kept
from solver.nlp.variables import Array
from solver.transcriptions.base import Collocation, Point, Segment, StepRow, Transcription

Kind = Literal["state", "control", "algebraic", "native", "drift"]
KINDS: tuple[Kind, ...] = ("state", "control", "algebraic", "native", "drift")

TimeKind = Literal["free", "fixed", "zero"]
"""A variable, a number, or the number zero, at which terms vanish."""

Made = TypeVar("Made")

_ROOM = 500_000  # instructions
_PLAIN = (0.0, 1.0)
"""Factors that need no symbol."""


@dataclass(frozen=True, slots=True)
class TimeSymbols:
    """A phase's two times in one stage function."""

    start: SX
    end: SX

    def at(self, fraction: SX) -> SX:
        """The time at a fraction of the duration."""
        return self.start + (self.end - self.start) * fraction


@dataclass(frozen=True, slots=True)
class SharedSymbols:
    """What all stages of a phase share in one stage function.

    ``p`` has statics, then the phase's constants, as the functions take them. ``symbols`` stacks
    what are variables, ``constants`` what are numbers: fixed times but zero, the constants.
    """

    times: TimeSymbols
    p: SX
    symbols: SX
    constants: SX


def shared_symbols(
    shape: PhaseShape, times: Sequence[TimeKind], symbols: SX | None = None
) -> SharedSymbols:
    """New symbols for times, statics and constants; of variables those that are given."""
    free, statics = times.count("free"), len(shape.statics)
    symbols = SX.sym("shared", free + statics) if symbols is None else symbols
    fixed, constants = SX.sym("time", times.count("fixed")), SX.sym("c", shape.constants)
    supply = {"free": iter(range(free)), "fixed": iter(range(fixed.numel()))}

    def time(kind: TimeKind) -> SX:
        if kind == "zero":
            return SX(0)
        return (symbols if kind == "free" else fixed)[next(supply[kind])]

    return SharedSymbols(
        TimeSymbols(*(time(kind) for kind in times)),
        ca.vertcat(ca.vertsplit(symbols, [0, free, free + statics])[1], constants),
        symbols,
        ca.vertcat(fixed, constants),
    )


@dataclass(frozen=True, slots=True)
class StageShape:
    """All that the symbols of a segment are built from.

    ``method`` is the transcription as something to compare; ``sizes`` has for each node how many
    variables of each kind it carries.
    """

    phase: PhaseShape
    method: Hashable
    eliminates: bool
    shares_controls: bool
    sizes: tuple[tuple[int, ...], ...]
    times: tuple[TimeKind, TimeKind]


@dataclass(slots=True)
class Stage:
    """A segment's symbols, and what is asked of it, evaluated when it is first asked for.

    Attributes
    ----------
    own
        The variables of its nodes, node by node, kind by kind.
    place
        Where it starts in the phase, its width, and that of the segment before it, as fractions
        of the duration, (3,).
    h
        Its length in seconds.
    """

    own: SX
    place: SX
    h: SX
    collocation: Collocation
    shared: SharedSymbols
    functions: PhaseFunctions
    _slopes: dict[int, SX]
    _known: dict[Hashable, Any] = field(default_factory=dict)

    @property
    def variables(self) -> SX:
        """Of the nodes, then those that the phase shares."""
        return ca.vertcat(self.own, self.shared.symbols)

    @property
    def constants(self) -> SX:
        """Of the segment, then those that the phase shares."""
        return ca.vertcat(self.place, self.shared.constants)

    def at_place(self, point: Point) -> Place:
        """A point of the segment as the functions take it."""
        return _place(point, self.shared)

    def path(self, node: int) -> SX:
        """The constraints along the phase at a node."""
        return self._once(("path", node), lambda: self._at(self.functions.path, node))

    def held(self, node: int, moving: tuple[bool, ...]) -> SX:
        """What contacts and loops hold, at a node; of what is ``moving`` the change."""

        def change() -> SX:
            start = self._at(self.functions.held, 0) * SX([float(one) for one in moving])
            return self._at(self.functions.held, node) - start

        return self._once(("held", node, moving), change)

    def slopes(self, node: int) -> SX:
        """The rates of the states at a node; mostly the transcription has asked for them."""
        point = self.collocation.points[node]
        if id(point) not in self._slopes:
            self._slopes[id(point)] = self._at(self.functions.derivatives, node)
        return self._slopes[id(point)]

    def integrals(self) -> SX:
        """The integrals over the segment, by the transcription's own rule."""
        return self._once("integrals", self._quadrature)

    def sums(self, weights: Array) -> tuple[SX, SX, Array]:
        """What ``weights`` (sums, integrals) make of the integrals: symbols, (sums,), values.

        A weight is a symbol where it is neither zero nor one.
        """
        plain = np.isin(weights, _PLAIN)
        pattern = tuple(np.where(plain, weights, np.nan).ravel().tolist())
        key = ("sums", weights.shape, tuple(repr(one) for one in pattern))
        symbols, sums = self._once(key, lambda: self._weighted(weights, plain))
        return symbols, sums, weights[~plain]

    def nodes(self, symbols: SX) -> ca.Function:
        """Reads segments out: variables, constants -> x, f, u, z (names, nodes), integrals.

        ``symbols`` are constants after the stage's own. z is zero where there are none.
        """
        return self._once(("nodes", symbols.numel()), lambda: self._reader(symbols))

    def ends(self) -> ca.Function:
        """Variables, place, constants -> x, u, z, natives of the first and of the last point."""
        return self._once("ends", self._end_points)

    def _once(self, key: Hashable, make: Callable[[], Made]) -> Made:
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]  # type: ignore[no-any-return]

    def _at(self, function: ca.Function, node: int) -> SX:
        return SX(function(*self.at_place(self.collocation.points[node]).arguments()))

    def _quadrature(self) -> SX:
        terms = [
            weight * SX(self.functions.integrands(*self.at_place(point).arguments()))
            for weight, point in self.collocation.quadrature
        ]
        return self.h * sum(terms[1:], start=terms[0])

    def _weighted(self, weights: Array, plain: Any) -> tuple[SX, SX]:
        symbols = SX.sym("weight", int(np.sum(~plain)))
        matrix, used = SX(ca.DM(np.where(plain, weights, 0.0))), iter(range(symbols.numel()))
        for row, column in np.argwhere(~plain).tolist():
            matrix[row, column] = symbols[next(used)]
        if not weights.size:
            return symbols, SX(len(weights), 1)
        return symbols, ca.mtimes(ca.sparsify(matrix), self.integrals())

    def _reader(self, symbols: SX) -> ca.Function:
        points = self.collocation.points
        outputs = [
            ca.horzcat(*(point.x for point in points)),
            ca.horzcat(*(self.slopes(node) for node in range(len(points)))),
            ca.horzcat(*(point.u for point in points)),
            ca.horzcat(*(point.z for point in points)),
            self.integrals(),
        ]
        constants = ca.vertcat(self.constants, symbols)
        return ca.Function("nodes", [self.variables, constants], outputs)

    def _end_points(self) -> ca.Function:
        outputs = [
            part
            for point in (self.collocation.points[0], self.collocation.points[-1])
            for part in (point.x, point.u, point.z, point.natives)
        ]
        inputs = [self.own, self.shared.symbols, self.place, self.shared.constants]
        return ca.Function("ends", inputs, outputs)


def _place(point: Point, shared: SharedSymbols) -> Place:
    return Place(point.x, point.u, point.z, point.natives, point.t, shared.p)


def stage_of(shape: StageShape, transcription: Transcription) -> Stage:
    """The segment of a shape, kept from the last one of the same shape."""
    return _STAGES.get(shape, lambda: _made(shape, transcription))


def functions_of(shape: PhaseShape, *, eliminate: bool) -> PhaseFunctions:
    """The functions of a phase, kept from the last one of the same shape."""
    return _FUNCTIONS.get((shape, eliminate), lambda: phase_functions(shape, eliminate=eliminate))


def _made(shape: StageShape, transcription: Transcription) -> Stage:
    functions = functions_of(shape.phase, eliminate=transcription.eliminates)
    shared, place = shared_symbols(shape.phase, shape.times), SX.sym("place", 3)
    fraction, width, width_before = ca.vertsplit(place)
    duration = shared.times.end - shared.times.start
    own = [
        [SX.sym(kind, size) for kind, size in zip(KINDS, sizes, strict=True)]
        for sizes in shape.sizes
    ]
    still = SX.zeros(shape.sizes[-1][KINDS.index("drift")], 1)  # nothing drifts at the start
    points = tuple(
        Point(
            x,
            u,
            ca.vertcat(z, drift if i else still),
            shared.times.at(fraction + node.fraction * width),
            natives,
        )
        for i, (node, (x, u, z, natives, drift)) in enumerate(
            zip(transcription.nodes, own, strict=True)
        )
    )
    h, slopes = duration * width, dict[int, SX]()
    asked: list[Point] = []  # kept, so that no other point gets the same id

    def derivative(point: Point) -> SX:
        if id(point) not in slopes:
            asked.append(point)
            slopes[id(point)] = SX(functions.derivatives(*_place(point, shared).arguments()))
        return slopes[id(point)]

    def flow(natives: SX, t: SX) -> SX:
        return SX(functions.flow(natives, t, shared.p))

    def step(start: Point, end: Point, before: SX, stretch: SX) -> tuple[SX, tuple[StepRow, ...]]:
        if functions.step is None:
            raise TypeError("this phase has no balance of steps")
        earlier = duration * width_before * before
        own = duration * width * stretch
        momentum, rows = functions.step(start.x, end.x, end.u, end.t, own, earlier, shared.p)
        pairs = zip(functions.step_rows, ca.vertsplit(rows) if rows.numel() else (), strict=True)
        return SX(momentum), tuple(one._replace(value=value) for one, value in pairs)

    collocation = transcription.collocate(Segment(points, h, derivative, flow, step))
    kept = {id(point): slopes[id(point)] for point in collocation.points if id(point) in slopes}
    stacked = ca.vertcat(*(part for parts in own for part in parts))
    return Stage(stacked, place, h, collocation, shared, functions, kept)


def _length(functions: PhaseFunctions) -> int:
    return int(functions.derivatives.n_instructions() + functions.path.n_instructions())


def _stage_length(stage: Stage) -> int:
    """About: every node evaluates the phase's functions once."""
    return len(stage.collocation.points) * _length(stage.functions)


_FUNCTIONS: Kept[PhaseFunctions] = Kept(_ROOM, _length)
_STAGES: Kept[Stage] = Kept(_ROOM, _stage_length)
