"""Adds the variables of one phase to the table: times, knots, and what lies between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from schemas.expressions import split
from solver.mesh import Mesh
from solver.model import OPEN, Interval, Phase, Static
from solver.model.drift import drift_names
from solver.model.shape import PhaseShape
from solver.nlp.scaling import typical_size
from solver.nlp.variables import Array, Indices, Variables
from solver.trajectory import Trajectory
from solver.transcribe.layout import Edge, PhaseLayout, Strip, strips_of
from solver.transcribe.stage import KINDS, Kind
from solver.transcriptions.base import Node, Transcription

Limits = Mapping[str, Interval]

_DENSE = np.linspace(0.0, 1.0, 5)
_SHORTEST = 1e-3  # s: of a guess
_EARLY = 1e-9


@dataclass(frozen=True, slots=True)
class _Quantity:
    """One kind of variable of a phase: names, limits along it and at its ends, sizes."""

    names: tuple[str, ...]
    along: Limits
    initial: Limits
    final: Limits
    scale: Array

    def of_orders(self, orders: Sequence[int]) -> "_Quantity":
        """The derivatives of these orders alone."""
        which = [i for i, name in enumerate(self.names) if split(name).order in orders]
        names = tuple(self.names[i] for i in which)
        return replace(self, names=names, scale=self.scale[which])


@dataclass(frozen=True, slots=True)
class Placer:
    """Places one phase; ``before`` is the end of the phase before it, if there is one."""

    variables: Variables
    index: int
    phase: Phase
    mesh: Mesh
    guess: Trajectory
    transcription: Transcription
    statics: tuple[int, ...]
    before: Edge | None
    shape: PhaseShape
    constants: tuple[float, ...]

    def place(self) -> PhaseLayout:
        """Add times, knots and inner nodes; where they stand."""
        start, end = self._times()
        quantities = self._quantities()
        whole = self.transcription
        shared: dict[Kind, bool] = {
            "state": True,
            "control": whole.shares_controls,
            "algebraic": whole.shares_controls,
            "native": False,
            "drift": False,
        }
        knots: dict[Kind, Indices] = {
            kind: self._block(quantities[kind], self.mesh.knots)
            if shared[kind]
            else np.empty((0, self.mesh.segments + 1), dtype=int)
            for kind in KINDS
        }
        strips = tuple(
            self._strip(one, where, knots, shared, quantities)
            for one, where in strips_of(whole, self.mesh)
        )
        return PhaseLayout(
            self.phase,
            self.mesh,
            whole,
            strips,
            knots,
            start,
            end,
            self.statics,
            quantities["state"].scale,
            self.shape,
            self.constants,
        )

    def _times(self) -> tuple[Edge, Edge]:
        phase = self.phase
        start = self.before
        if start is None:
            start = self._edge("start", phase.start or Interval(0.0, 0.0), self.guess.start)
        limits = phase.end
        if start.index is None:  # the duration's limits are the end's
            earliest, latest = (start.limits.lower + side for side in phase.duration)
            limits = Interval(max(limits.lower, earliest), min(limits.upper, latest))
        return start, self._edge("end", limits, self.guess.end)

    def _edge(self, name: str, limits: Interval, guess: float) -> Edge:
        if limits.fixed:
            return Edge(None, limits)
        sides = (np.full((1, 1), limits.lower), np.full((1, 1), limits.upper))
        scale = np.array([max(self.guess.end - self.guess.start, _SHORTEST)])
        at = np.array([np.nan])
        indices = self.variables.add(
            self.index, (f"{name} time",), at, sides, np.full((1, 1), guess), scale
        )
        return Edge(int(indices[0, 0]), limits)

    def _quantities(self) -> dict[Kind, _Quantity]:
        phase = self.phase
        unknown = () if self.transcription.eliminates else phase.algebraic
        free = dict.fromkeys(unknown, OPEN)
        tables = (phase.bounds, phase.initial, phase.final)

        def quantity(names: tuple[str, ...], tables: tuple[Limits, Limits, Limits]) -> _Quantity:
            along, initial, final = tables
            return _Quantity(names, along, initial, final, self._sizes(names, tables))

        return {
            "state": quantity(phase.states, tables),
            "control": quantity(phase.controls, tables),
            "algebraic": quantity(unknown, (free, free, free)),
            "native": self._natives(),
            "drift": self._drift(),
        }

    def _drift(self) -> _Quantity:
        """What keeps contacts and loops from drifting."""
        names = drift_names(self.phase.form)
        free = dict.fromkeys(names, OPEN)
        return _Quantity(names, free, free, free, np.ones(len(names)))

    def _natives(self) -> _Quantity:
        """Derivatives of the method's own curves, where it has any as variables."""
        orders = {order for node in self.transcription.nodes for order in node.native}
        names = tuple(name for name in self.phase.natives if split(name).order in orders)
        free = dict.fromkeys(names, OPEN)
        return _Quantity(names, free, free, free, self._sizes(names, (free, free, free)))

    def _sizes(self, names: Sequence[str], tables: Sequence[Limits]) -> Array:
        limits = [[side for table in tables for side in table[name]] for name in names]
        samples = self.guess.sample(names, self.mesh.fractions(_DENSE).ravel())
        sides = np.array(limits).reshape(len(names), 6)
        return typical_size(sides, samples, self._rates(names))

    def _rates(self, names: Sequence[str]) -> Array:
        """Sizes of derivatives that the method itself takes, in a short phase; zero: unknown."""
        orders = np.array([split(name).order for name in names], dtype=float).reshape(-1, 1)
        duration = max(self.guess.end - self.guess.start, _SHORTEST)
        known = self.transcription.native and duration < 1.0
        return np.asarray(np.where(orders > 0, duration**-orders, 0.0) * known)

    def _strip(
        self,
        transcription: Transcription,
        where: Indices,
        knots: Mapping[Kind, Indices],
        shared: Mapping[Kind, bool],
        quantities: Mapping[Kind, _Quantity],
    ) -> Strip:
        starts, widths = self.mesh.knots[:-1][where], np.diff(self.mesh.knots)[where]
        last = len(transcription.nodes) - 1

        def at_node(kind: Kind, number: int, node: Node) -> Indices:
            if shared[kind] and number in (0, last):
                return knots[kind][:, where + (number == last)]
            if not (number > 0 if kind == "drift" else getattr(node, kind)):
                return np.empty((0, len(where)), dtype=int)
            fractions = starts + node.fraction * widths
            if node.fraction == 1.0:  # exactly: the limits of the end are told by it
                fractions = self.mesh.knots[1:][where]
            quantity = quantities[kind]
            if kind == "native":
                quantity = quantity.of_orders(node.native)
            return self._block(quantity, fractions)

        blocks = {
            kind: tuple(at_node(kind, i, node) for i, node in enumerate(transcription.nodes))
            for kind in KINDS
        }
        places = np.stack([starts, widths, self._widths_before()[where]])
        return Strip(transcription, where, places, blocks)

    def _widths_before(self) -> Array:
        """How wide the segment before each is; nothing comes before the first but in a period."""
        widths = np.diff(self.mesh.knots)
        return np.concatenate([widths[-1:] if self.phase.wraps else [0.0], widths[:-1]])

    def _block(self, quantity: _Quantity, where: Array) -> Indices:
        """Variables at some places; with the ends' limits at the phase's ends."""
        names = quantity.names
        # What is constant in a time step is the value at its end, not at the start of the next.
        early = 1 - _EARLY if self.transcription.stepped else 1.0
        guess = self.guess.sample(names, where * early)
        lower, upper = (np.empty_like(guess) for _ in range(2))
        for row, name in enumerate(names):
            lower[row], upper[row] = quantity.along[name]
            for at, limits in ((0.0, quantity.initial), (1.0, quantity.final)):
                lower[row, where == at], upper[row, where == at] = limits[name]
        return self.variables.add(self.index, names, where, (lower, upper), guess, quantity.scale)


def place_statics(
    variables: Variables, statics: Sequence[Static], values: Sequence[float]
) -> tuple[int, ...]:
    """Add the problem's statics to the table, starting at ``values``."""
    places = []
    for static, value in zip(statics, values, strict=True):
        sides = (np.full((1, 1), static.limits.lower), np.full((1, 1), static.limits.upper))
        limits = np.array([[*static.limits]])
        scale = typical_size(limits, np.full((1, 1), value))
        block = variables.add(
            None, (static.name,), np.array([np.nan]), sides, np.full((1, 1), value), scale
        )
        places.append(int(block[0, 0]))
    return tuple(places)
