"""Problem -> Model: systems lowered, constants evaluated, bounds intersected."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from schemas import resolve
from schemas.expressions import Name, Tree
from schemas.phases import Constraint as ConstraintSpec
from schemas.phases import Phase as PhaseSpec
from schemas.problem import Problem
from schemas.problem import Static as StaticSpec
from schemas.values import Bound
from solver.lowering import Form, Slacks, lower, lower_native, slacks
from solver.model.implied import Implied, implied
from solver.model.model import OPEN, Constraint, Interval, Model, Phase, Static
from solver.model.resting import resting_rates, spare_velocities

START = "start "
"""In front of the label of a row that contacts or loops ask for at a phase's start."""


def build_model(problem: Problem, native: Sequence[bool] | None = None) -> Model:
    """The model of a checked problem (``schemas.reading.read_problem``).

    ``native`` tells for each phase whether its method differentiates its own curves.
    """
    forms = lower(problem)
    native = native or [False] * len(forms)
    softened = problem.nonsmooth is not None and problem.nonsmooth.abs == "slack"
    phases = []
    ends = implied(problem, forms)
    for index, (spec, chain) in enumerate(zip(problem.phases, forms, strict=True)):
        form = lower_native(problem, index) if native[index] else chain
        extra = slacks(problem, index) if softened else None
        phase = _phase(spec, form, chain, extra, first=index == 0)
        phases.append(_with_ends(phase, ends[index], list(problem.static)))
    objective = problem.objective.minimize.tree if problem.objective else None
    statics = tuple(read_static(name, spec) for name, spec in problem.static.items())
    linkages = tuple(_constraint("linkage", row, {}) for row in problem.linkages)
    return Model(tuple(phases), objective, statics, linkages)


def _with_ends(phase: Phase, ends: Implied, statics: Sequence[str]) -> Phase:
    """What contacts and loops hold at the start, and without what they decide."""
    idle = {f"path {name}" for name in ends.idle}
    phase = replace(
        phase,
        path=tuple(row for row in phase.path if row.label not in idle),
        settled={f"path {name}": frozenset(where) for name, where in ends.settled.items()},
    )
    if not phase.form.holonomic:
        return phase
    rates = [one.rate for one in phase.form.holonomic if one.rate in ends.starts]
    resting = resting_rates(phase.form, phase.initial, rates, statics)
    spare = spare_velocities(phase.form, phase.final, statics)
    zero = Interval(0.0, 0.0)
    starts = [
        Constraint(f"{START}{name}", Name(f"initial.{name}"), zero)
        for name in ends.starts
        if name not in resting
    ]
    return replace(
        phase,
        boundary=(*phase.boundary, *starts),
        final={**phase.final, **{name: phase.bounds[name] for name in spare}},
    )


def _phase(spec: PhaseSpec, form: Form, chain: Form, extra: Slacks | None, *, first: bool) -> Phase:
    constants = form.constants
    variables = [*form.states, *form.controls]
    bounds = {name: _interval(spec.bounds.get(name), constants) for name in variables}

    def ends(given: Mapping[str, Bound]) -> dict[str, Interval]:
        return {name: _meet(bounds[name], _interval(given.get(name), constants)) for name in bounds}

    path = [_constraint("path", row, constants) for row in spec.path]
    path += _limits("bound", spec.bounds, bounds, constants)
    boundary = [_constraint("boundary", row, constants) for row in spec.boundary]
    for side, given in (("initial", spec.initial), ("final", spec.final)):
        boundary += _limits(side, given, bounds, constants, prefix=f"{side}.")
    names = extra.names if extra else ()
    return Phase(
        name=spec.name,
        form=form,
        algebraic=(*form.algebraic, *names),
        natives=form.natives or _initials(form),
        integrals=extra.integrals if extra else _trees(spec),
        path=tuple(path),
        held=tuple(_rows_of(form, extra)),
        boundary=tuple(boundary),
        bounds=bounds,
        initial=ends(spec.initial),
        final=ends(spec.final),
        start=_interval(spec.time.start, constants) if first else None,
        end=_interval(spec.time.final, constants),
        duration=_interval(spec.time.duration, constants),
        chain=chain,
        wraps=spec.periodic is not None,
    )


def _trees(spec: PhaseSpec) -> dict[str, Tree]:
    return {name: expression.tree for name, expression in spec.integrals.items()}


def _initials(form: Form) -> tuple[str, ...]:
    """What a closed form's formulas know of their phase's start."""
    if not form.flow:
        return ()
    return (*(f"initial.{name}" for name in form.states), "initial.t")


def _rows_of(form: Form, extra: Slacks | None) -> list[Constraint]:
    """What the form itself asks for at every node."""
    zero, above = Interval(0.0, 0.0), Interval(0.0, math.inf)
    rows = [
        Constraint(label, tree, zero)
        for group in form.unknowns
        for label, tree in zip(group.labels, group.residuals, strict=True)
    ]
    rows += [Constraint(label, tree, zero) for label, tree in form.residuals.items()]
    if extra is not None:
        rows += [Constraint(label, tree, above) for label, tree in extra.rows.items()]
    return rows


def _limits(
    label: str,
    given: Mapping[str, Bound],
    variables: Mapping[str, Interval],
    constants: Mapping[str, float],
    prefix: str = "",
) -> list[Constraint]:
    """Limits on what is no variable of the form, such as an acceleration, as constraints."""
    rows = [
        Constraint(f"{label} {name}", Name(prefix + name), _interval(bound, constants))
        for name, bound in given.items()
        if name not in variables
    ]
    return [row for row in rows if row.limits.finite]


def _interval(limited: Bound | ConstraintSpec | None, constants: Mapping[str, float]) -> Interval:
    return Interval(*resolve.interval(limited, constants))


def _meet(a: Interval, b: Interval) -> Interval:
    return Interval(max(a.lower, b.lower), min(a.upper, b.upper))


def _constraint(kind: str, spec: ConstraintSpec, constants: Mapping[str, float]) -> Constraint:
    return Constraint(f"{kind} {spec.name}", spec.expression.tree, _interval(spec, constants))


def read_static(name: str, spec: StaticSpec) -> Static:
    """A static with its limits, and its own guess or the middle of them."""
    limits = _interval(spec.bounds, {})
    if spec.guess is not None:
        return Static(name, limits, resolve.scalar(spec.guess, {}))
    if math.isinf(limits.lower) or math.isinf(limits.upper):
        return Static(name, limits, limits.nearest(1.0 if limits == OPEN else 0.0))
    return Static(name, limits, (limits.lower + limits.upper) / 2)
