"""The model's expressions as CasADi functions of a phase's states, controls and time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from solver.expressions import SX, evaluate
from solver.model.model import Model, Phase


@dataclass(frozen=True, slots=True)
class PhaseFunctions:
    """Functions of (x, u, t): derivatives (n_x,), integrands (n_q,), path values (n_c,)."""

    derivatives: ca.Function
    integrands: ca.Function
    path: ca.Function


def phase_functions(phase: Phase) -> PhaseFunctions:
    """Build the functions of one phase; named intermediates are shared subexpressions."""
    x, u, t = (SX.sym(name, size) for name, size in _sizes(phase))
    scope = {name: SX(value) for name, value in phase.parameters.items()}
    scope |= {name: x[i] for i, name in enumerate(phase.states)}
    scope |= {name: u[i] for i, name in enumerate(phase.controls)}
    scope["t"] = t
    for name, tree in phase.definitions.items():
        scope[name] = evaluate(tree, scope)

    def function(name: str, outputs: Sequence[SX]) -> ca.Function:
        return ca.Function(name, [x, u, t], [ca.vertcat(SX(0, 1), *outputs)])

    return PhaseFunctions(
        function("derivatives", [evaluate(tree, scope) for tree in phase.derivatives]),
        function("integrands", [evaluate(tree, scope) for tree in phase.integrals.values()]),
        function("path", [evaluate(row.tree, scope) for row in phase.path]),
    )


def _sizes(phase: Phase) -> list[tuple[str, int]]:
    return [("x", len(phase.states)), ("u", len(phase.controls)), ("t", 1)]


@dataclass(frozen=True, slots=True)
class Ends:
    """Symbols at the two ends of a phase, and its integrals."""

    x: tuple[SX, SX]
    u: tuple[SX, SX]
    t: tuple[SX, SX]
    integrals: SX


def boundary_scope(phase: Phase, ends: Ends) -> dict[str, SX]:
    """Names that boundary constraints of this phase may use."""
    scope = {name: SX(value) for name, value in phase.parameters.items()}
    scope |= {name: ends.integrals[i] for i, name in enumerate(phase.integrals)}
    for side, label in enumerate(("initial", "final")):
        scope |= {f"{label}.{name}": ends.x[side][i] for i, name in enumerate(phase.states)}
        scope |= {f"{label}.{name}": ends.u[side][i] for i, name in enumerate(phase.controls)}
        scope[f"{label}.t"] = ends.t[side]
    scope["duration"] = ends.t[1] - ends.t[0]
    return scope


def objective_scope(model: Model, scopes: Sequence[Mapping[str, SX]]) -> dict[str, SX]:
    """Names that the objective may use: every phase's under its prefix, the only one's bare."""
    scope = {
        f"{phase.name}.{name}": value
        for phase, names in zip(model.phases, scopes, strict=True)
        for name, value in names.items()
    }
    return scope | dict(scopes[0]) if len(scopes) == 1 else scope
