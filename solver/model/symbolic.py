"""A phase's expressions as CasADi functions along it, and the names known at its ends."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from schemas.expressions import derivative
from solver.discrete import Step, step_rows, turn_rows
from solver.expressions import SX, scalars
from solver.model.drift import drift_names, drift_rates, held_values
from solver.model.model import Constraint, Phase
from solver.model.shape import ModelShape, PhaseShape, Solved
from solver.model.slots import Expr, valued
from solver.transcriptions.base import StepRow

INSIDE = (0.25, 0.5, 0.75)
"""Where within a step bodies must not be inside of each other; at its end there is a row anyway."""

GRAZE = 3e-3
"""How deep they may be there, m: a straight step between two points cuts corners."""


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a phase in symbols.

    State (n_x,), control (n_u,), algebraic (n_z,) and native values (n_n,), time; statics, then
    the phase's constants (n_p,). The algebraic values end with those against drift.
    """

    x: SX
    u: SX
    z: SX
    natives: SX
    t: SX
    p: SX

    def arguments(self) -> list[SX]:
        """What the functions of a phase take."""
        return [self.x, self.u, self.z, self.natives, self.t, self.p]


@dataclass(frozen=True, slots=True)
class PhaseFunctions:
    """Functions of a place: derivatives (n_x,), integrands (n_q,), path values (n_c,).

    ``flow`` gives the states (n_x,) of a closed form from natives, time, statics and constants.
    ``held`` gives what contacts and loops hold (``solver.model.drift``).
    ``step`` gives the balance of momentum of a step (n_q,), and its ``step_rows``: from the states
    at both ends, controls, the time at its end, its length, that of the step before, and statics.
    ``native_rows`` are the positions of path constraints that use natives.
    """

    derivatives: ca.Function
    integrands: ca.Function
    path: ca.Function
    flow: ca.Function
    held: ca.Function
    native_rows: frozenset[int]
    step: ca.Function | None = None
    step_rows: tuple[StepRow, ...] = ()


def phase_functions(shape: PhaseShape, *, eliminate: bool) -> PhaseFunctions:
    """Build the functions of one phase; named intermediates are shared subexpressions."""
    drift = drift_names(shape)
    place = Place(
        *(
            SX.sym(name, size)
            for name, size in (
                ("x", len(shape.states)),
                ("u", len(shape.controls)),
                ("z", 0 if eliminate else len(shape.algebraic) + len(drift)),
                ("n", len(shape.natives)),
                ("t", 1),
                ("p", len(shape.statics) + shape.constants),
            )
        )
    )
    scope = along_scope(shape, place, eliminate=eliminate)

    def function(name: str, outputs: Sequence[SX]) -> ca.Function:
        return ca.Function(name, place.arguments(), [ca.vertcat(SX(0, 1), *outputs)])

    known = dict(shape.derivatives)
    rates = [scope.valued(known[name]) if name in known else SX(0) for name in shape.states]
    if drift and not eliminate:
        added = drift_rates(shape, scope, place.x, place.z[len(shape.algebraic) :])
        rates = [rate + added[i] for i, rate in enumerate(rates)]
    solved = {label for group in shape.unknowns for label in group.labels if eliminate}
    held = [row for label, row in shape.held if label not in solved]
    rows = [scope.valued(row) for row in (*shape.path, *held)]
    flow = ca.vertcat(SX(0, 1), *map(scope.valued, shape.flow))
    return PhaseFunctions(
        function("derivatives", rates),
        function("integrands", [scope.valued(expr) for _, expr in shape.integrals]),
        function("path", rows),
        ca.Function("flow", [place.natives, place.t, place.p], [flow]),
        function("held", [held_values(shape, scope)]),
        frozenset(i for i, row in enumerate(rows) if _uses(row, place.natives)),
        *_step(shape, place, scope),
    )


def _step(
    shape: PhaseShape, end: Place, scope: "Along"
) -> tuple[ca.Function | None, tuple[StepRow, ...]]:
    """The balance over a step that ends at a place, and the rows beside it."""
    if shape.stepped is None:
        return None, ()
    principle, solid = shape.stepped.principle, shape.stepped.solid
    start, h, before = SX.sym("start", end.x.numel()), SX.sym("h"), SX.sym("before")
    count = len(shape.states) // 2
    (q0, v0), (q1, v1) = ((x[:count], x[count : 2 * count]) for x in (start, end.x))
    rest = end.x[2 * count :]
    if principle is None:
        rates = {
            derivative(name, 2): (v1[i] - v0[i]) / h for i, name in enumerate(shape.states[:count])
        }
        whole = scope.beside(rates)
        momentum = ca.vertcat(*(h * whole.valued(expr) for expr in shape.stepped.balance))
        rows = []
    else:
        found = step_rows(principle, Step(q0, v0, q1, v1, h, before, scope))
        momentum = found.momentum
        slips = zip(principle.slides, ca.vertsplit(found.slips), strict=False)
        rows = [StepRow(f"slip {one.pair}{one.axis}", scope[one.slack] - s) for one, s in slips]
        rows += [StepRow(*row) for row in turn_rows(principle, q0, q1)]
    for share in INSIDE if solid else ():
        x = ca.vertcat(q0 + share * (q1 - q0), v1, rest)
        within = along_scope(shape, replace(end, x=x), eliminate=False)
        rows += [StepRow(f"{gap} inside", within[gap], -GRAZE, math.inf) for gap in solid]
    inputs = [start, end.x, end.u, end.t, h, before, end.p]
    values = ca.vertcat(SX(0, 1), *(row.value for row in rows))
    return ca.Function("step", inputs, [momentum, values]), tuple(rows)


def path_rows(phase: Phase, *, eliminate: bool) -> list[Constraint]:
    """The constraints along the phase, the user's first; those of unknowns unless eliminated."""
    solved = {label for group in phase.form.unknowns for label in group.labels if eliminate}
    return [*phase.path, *(row for row in phase.held if row.label not in solved)]


def _uses(row: SX, symbols: SX) -> bool:
    return bool(symbols.numel()) and any(ca.which_depends(row, symbols, 1, False))


class Along(dict[str, SX]):
    """Names along a phase; an intermediate is evaluated when it is first asked for."""

    def __init__(self, shape: PhaseShape, known: Mapping[str, SX], constants: Sequence[SX]) -> None:
        super().__init__(known)
        self._shape, self._trees = shape, dict(shape.definitions)
        self._constants = constants

    def __missing__(self, name: str) -> SX:
        self[name] = self.valued(self._trees[name])
        return self[name]

    def valued(self, expr: Expr) -> SX:
        """The value of an expression of the phase."""
        return valued(expr, self, self._constants)

    def beside(self, names: Mapping[str, SX]) -> "Along":
        """With further names; what is evaluated already stays as it is."""
        return Along(self._shape, {**self, **names}, self._constants)

    def solve(self, group: Solved) -> dict[str, SX]:
        """Unknowns from residuals that are linear in them, by a symbolic solve."""
        unknown = SX.sym("unknown", len(group.names))
        named = {name: unknown[i] for i, name in enumerate(group.names)}
        scope = self.beside(named)
        rows = ca.vertcat(*map(scope.valued, group.residuals))
        matrix = ca.jacobian(rows, unknown)
        rest = ca.substitute(rows, unknown, SX.zeros(*unknown.shape))
        solved = -ca.solve(matrix, rest)
        return {name: solved[i] for i, name in enumerate(group.names)}


def along_scope(shape: PhaseShape, place: Place, *, eliminate: bool) -> Along:
    """Every name that an expression along the phase may use, intermediates when asked for."""
    known: dict[str, SX] = {}
    if shape.stepped is not None:
        known = {name: valued(expr, {}, ()) for name, expr in shape.stepped.parameters}
    for names, values in (
        (shape.statics, place.p),
        (shape.states, place.x),
        (shape.controls, place.u),
        (shape.natives, place.natives),
        (() if eliminate else shape.algebraic, place.z),
    ):
        known |= {name: values[i] for i, name in enumerate(names)}
    known["t"] = place.t
    constants = scalars(place.p)[len(shape.statics) :]
    scope = Along(shape, known, constants)
    if eliminate:
        for group in shape.unknowns:
            known |= scope.solve(group)
            scope = Along(shape, known, constants)
    return scope


@dataclass(frozen=True, slots=True)
class Ends:
    """The two ends of a phase in symbols, and its integrals (n_q,)."""

    initial: Place
    final: Place
    integrals: SX


def boundary_scope(shape: PhaseShape, ends: Ends, *, eliminate: bool) -> Mapping[str, SX]:
    """Names that boundary constraints of this phase may use."""
    scope = {name: ends.integrals[i] for i, (name, _) in enumerate(shape.integrals)}
    scope |= {name: ends.initial.p[i] for i, name in enumerate(shape.statics)}
    scope["duration"] = ends.final.t - ends.initial.t
    rooms = {
        f"{label}.": along_scope(shape, place, eliminate=eliminate)
        for label, place in (("initial", ends.initial), ("final", ends.final))
    }
    return _Prefixed(scope, rooms)


class _Prefixed(dict[str, SX]):
    """Names of its own, and those of other scopes behind their prefixes, the longest first."""

    def __init__(self, own: Mapping[str, SX], rooms: Mapping[str, Mapping[str, SX]]) -> None:
        super().__init__(own)
        self._rooms = sorted(rooms.items(), key=lambda room: -len(room[0]))

    def __missing__(self, name: str) -> SX:
        for prefix, scope in self._rooms:
            if name.startswith(prefix):
                try:
                    return scope[name[len(prefix) :]]
                except KeyError:
                    continue
        raise KeyError(name)


def objective_scope(
    shape: ModelShape, scopes: Sequence[Mapping[str, SX]], statics: SX
) -> Mapping[str, SX]:
    """Names of objective and linkages: every phase's under its prefix, the only one's bare."""
    own = {name: statics[i] for i, name in enumerate(shape.statics)}
    rooms = {f"{name}.": names for name, names in zip(shape.names, scopes, strict=True)}
    if len(scopes) == 1:
        rooms[""] = scopes[0]
    return _Prefixed(own, rooms)
