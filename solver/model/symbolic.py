"""The model's expressions as CasADi functions along a phase, and the names known at its ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from schemas.expressions import Tree
from solver.expressions import SX, evaluate
from solver.lowering import Unknowns
from solver.model.drift import drift_names, drift_rates, held_values
from solver.model.model import Constraint, Model, Phase


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a phase in symbols.

    State (n_x,), control (n_u,), algebraic (n_z,) and native values (n_n,), time, statics (n_p,).
    The algebraic values end with those against drift.
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

    ``flow`` gives the states (n_x,) of a closed form from natives, time and statics.
    ``held`` gives what contacts and loops hold (``solver.model.drift``).
    ``native_rows`` are the positions of path constraints that use natives.
    """

    derivatives: ca.Function
    integrands: ca.Function
    path: ca.Function
    flow: ca.Function
    held: ca.Function
    native_rows: frozenset[int]


def phase_functions(phase: Phase, statics: Sequence[str], *, eliminate: bool) -> PhaseFunctions:
    """Build the functions of one phase; named intermediates are shared subexpressions."""
    form, drift = phase.form, drift_names(phase.form)
    place = Place(
        *(
            SX.sym(name, size)
            for name, size in (
                ("x", len(phase.states)),
                ("u", len(phase.controls)),
                ("z", 0 if eliminate else len(phase.algebraic) + len(drift)),
                ("n", len(phase.natives)),
                ("t", 1),
                ("p", len(statics)),
            )
        )
    )
    scope = along_scope(phase, place, statics, eliminate=eliminate)

    def function(name: str, outputs: Sequence[SX]) -> ca.Function:
        return ca.Function(name, place.arguments(), [ca.vertcat(SX(0, 1), *outputs)])

    rates = [
        evaluate(form.derivatives[name], scope) if name in form.derivatives else SX(0)
        for name in phase.states
    ]
    if drift and not eliminate:
        added = drift_rates(form, scope, place.x, place.z[len(phase.algebraic) :])
        rates = [rate + added[i] for i, rate in enumerate(rates)]
    rows = [evaluate(row.tree, scope) for row in path_rows(phase, eliminate=eliminate)]
    flow = ca.vertcat(SX(0, 1), *(evaluate(tree, scope) for tree in form.flow.values()))
    return PhaseFunctions(
        function("derivatives", rates),
        function("integrands", [evaluate(tree, scope) for tree in phase.integrals.values()]),
        function("path", rows),
        ca.Function("flow", [place.natives, place.t, place.p], [flow]),
        function("held", [held_values(form, scope)]),
        frozenset(i for i, row in enumerate(rows) if _uses(row, place.natives)),
    )


def path_rows(phase: Phase, *, eliminate: bool) -> list[Constraint]:
    """The constraints along the phase, the user's first; those of unknowns unless eliminated."""
    solved = {label for group in phase.form.unknowns for label in group.labels if eliminate}
    return [*phase.path, *(row for row in phase.held if row.label not in solved)]


def _uses(row: SX, symbols: SX) -> bool:
    return bool(symbols.numel()) and any(ca.which_depends(row, symbols, 1, False))


def along_scope(
    phase: Phase, place: Place, statics: Sequence[str], *, eliminate: bool = False
) -> dict[str, SX]:
    """Every name that an expression along the phase may use, intermediates when asked for."""
    scope = {name: SX(value) for name, value in phase.parameters.items()}
    for names, values in (
        (statics, place.p),
        (phase.states, place.x),
        (phase.controls, place.u),
        (phase.natives, place.natives),
        (() if eliminate else phase.algebraic, place.z),
    ):
        scope |= {name: values[i] for i, name in enumerate(names)}
    scope["t"] = place.t
    if eliminate:
        for group in phase.form.unknowns:
            scope |= _solved(phase, scope, group)
    return _Definitions(phase, scope)


class _Definitions(dict[str, SX]):
    """A scope that evaluates an intermediate when it is first asked for."""

    def __init__(self, phase: Phase, known: Mapping[str, SX]) -> None:
        super().__init__(known)
        self._trees: Mapping[str, Tree] = phase.form.definitions

    def __missing__(self, name: str) -> SX:
        self[name] = evaluate(self._trees[name], self)
        return self[name]


def _solved(phase: Phase, known: Mapping[str, SX], group: Unknowns) -> dict[str, SX]:
    """Unknowns eliminated from residuals that are linear in them, by a symbolic solve."""
    unknown = SX.sym("unknown", len(group.names))
    named = {name: unknown[i] for i, name in enumerate(group.names)}
    scope = _Definitions(phase, {**known, **named})
    rows = ca.vertcat(*(evaluate(tree, scope) for tree in group.residuals))
    matrix = ca.jacobian(rows, unknown)
    rest = ca.substitute(rows, unknown, SX.zeros(*unknown.shape))
    solved = -ca.solve(matrix, rest)
    return {name: solved[i] for i, name in enumerate(group.names)}


@dataclass(frozen=True, slots=True)
class Ends:
    """The two ends of a phase in symbols, and its integrals (n_q,)."""

    initial: Place
    final: Place
    integrals: SX


def boundary_scope(
    phase: Phase, ends: Ends, statics: Sequence[str], *, eliminate: bool
) -> dict[str, SX]:
    """Names that boundary constraints of this phase may use."""
    scope = {name: SX(value) for name, value in phase.parameters.items()}
    scope |= {name: ends.integrals[i] for i, name in enumerate(phase.integrals)}
    scope |= {name: ends.initial.p[i] for i, name in enumerate(statics)}
    scope["duration"] = ends.final.t - ends.initial.t
    rooms = {
        f"{label}.": along_scope(phase, place, statics, eliminate=eliminate)
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


def objective_scope(model: Model, scopes: Sequence[Mapping[str, SX]], statics: SX) -> dict[str, SX]:
    """Names of objective and linkages: every phase's under its prefix, the only one's bare."""
    own = {static.name: statics[i] for i, static in enumerate(model.statics)}
    rooms = {f"{phase.name}.": names for phase, names in zip(model.phases, scopes, strict=True)}
    if len(scopes) == 1:
        rooms[""] = scopes[0]
    return _Prefixed(own, rooms)
