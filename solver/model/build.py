"""Problem -> Model: constants evaluated, bounds intersected, names gone from pydantic."""

from collections.abc import Mapping

from schemas import resolve
from schemas.phases import Constraint as ConstraintSpec
from schemas.phases import Phase as PhaseSpec
from schemas.problem import Problem
from schemas.values import Bound
from solver.model.model import Constraint, Interval, Model, Phase


def build_model(problem: Problem) -> Model:
    """The model of a checked problem (``schemas.reading.read_problem``)."""
    objective = problem.objective.minimize.tree if problem.objective else None
    return Model(tuple(_phase(phase) for phase in problem.phases), objective)


def _phase(spec: PhaseSpec) -> Phase:
    system = spec.system
    constants = resolve.parameters(system)
    names = [*system.states, *system.controls]
    bounds = {name: _interval(spec.bounds.get(name), constants) for name in names}

    def ends(given: Mapping[str, Bound]) -> dict[str, Interval]:
        return {name: _meet(bounds[name], _interval(given.get(name), constants)) for name in names}

    return Phase(
        name=spec.name,
        states=tuple(system.states),
        controls=tuple(system.controls),
        parameters=constants,
        definitions={name: expression.tree for name, expression in system.define.items()},
        derivatives=tuple(system.derivatives[name].tree for name in system.states),
        integrals={name: expression.tree for name, expression in spec.integrals.items()},
        path=tuple(_constraint(constraint, constants) for constraint in spec.path),
        boundary=tuple(_constraint(constraint, constants) for constraint in spec.boundary),
        bounds=bounds,
        initial=ends(spec.initial),
        final=ends(spec.final),
        start=_interval(spec.time.start, constants),
        end=_interval(spec.time.final, constants),
    )


def _interval(limited: Bound | ConstraintSpec | None, constants: Mapping[str, float]) -> Interval:
    return Interval(*resolve.interval(limited, constants))


def _meet(a: Interval, b: Interval) -> Interval:
    return Interval(max(a.lower, b.lower), min(a.upper, b.upper))


def _constraint(spec: ConstraintSpec, constants: Mapping[str, float]) -> Constraint:
    return Constraint(spec.name, spec.expression.tree, _interval(spec, constants))
