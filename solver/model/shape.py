"""The shape of a model: its trees without the values of its constants.

Two models of one shape need the same functions; only the constants that are put into them differ.
A shape holds every name, operator and number that its functions are built from, so that models
that differ in any of these differ in their shapes.
"""

import functools
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field

from schemas.expressions import Name, Number
from solver.frozen import frozen
from solver.lowering import Form, Holonomic
from solver.mechanics.principle import Principle
from solver.model.model import Model, Phase
from solver.model.slots import Expr, Slots

_ENDS = ("initial.", "final.")


@dataclass(frozen=True, slots=True)
class Solved:
    """Unknowns of a phase and the residuals that they are found from."""

    names: tuple[str, ...]
    residuals: tuple[Expr, ...]
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Stepped:
    """A motion in time steps: what balances momentum over one, or is kept apart within it.

    Its constants stay what they are: ``principle`` has trees over their names. It is compared by
    ``key``, which has all of it.
    """

    principle: Principle | None = field(compare=False)
    key: Hashable
    balance: tuple[Expr, ...]
    solid: tuple[str, ...]
    parameters: tuple[tuple[str, Expr], ...]


@dataclass(frozen=True, slots=True)
class PhaseShape:
    """What the functions of a phase are built from, but for its ``constants``' values.

    ``path`` and ``held`` are constraints along the phase, ``boundary`` those over its ends;
    ``constants`` counts the slots. Two phases of equal shapes differ in numbers alone.
    """

    states: tuple[str, ...]
    controls: tuple[str, ...]
    algebraic: tuple[str, ...]
    natives: tuple[str, ...]
    statics: tuple[str, ...]
    constants: int
    definitions: tuple[tuple[str, Expr], ...]
    derivatives: tuple[tuple[str, Expr], ...]
    unknowns: tuple[Solved, ...]
    flow: tuple[Expr, ...]
    integrals: tuple[tuple[str, Expr], ...]
    path: tuple[Expr, ...]
    held: tuple[tuple[str, Expr], ...]
    boundary: tuple[Expr, ...]
    holonomic: tuple[Holonomic, ...]
    stepped: Stepped | None


@dataclass(frozen=True, slots=True)
class ModelShape:
    """The shapes of the phases; of objective and linkages, which have ``constants`` of their own.

    ``names`` are the phases'.
    """

    phases: tuple[PhaseShape, ...]
    names: tuple[str, ...]
    statics: tuple[str, ...]
    objective: Expr
    linkages: tuple[Expr, ...]
    constants: int


@dataclass(frozen=True, slots=True)
class Constants:
    """The values that belong to a shape: each phase's, and those of objective and linkages."""

    phases: tuple[tuple[float, ...], ...]
    joint: tuple[float, ...]


def shape_of(model: Model) -> tuple[ModelShape, Constants]:
    """The shape of a model, and the values of its constants."""
    statics = tuple(static.name for static in model.statics)
    known = [_known(phase, statics) for phase in model.phases]
    own = [
        Slots(_at_ends(values), closed=_is_stepped(phase.form))
        for phase, values in zip(model.phases, known, strict=True)
    ]
    phases = tuple(
        _phase_shape(phase, slots, values, statics)
        for phase, slots, values in zip(model.phases, own, known, strict=True)
    )
    joint = Slots(_over_phases(model, [slots.value_of for slots in own]))
    objective = joint.expr(Number(0.0) if model.objective is None else model.objective)
    linkages = tuple(joint.expr(row.tree) for row in model.linkages)
    names = tuple(phase.name for phase in model.phases)
    shape = ModelShape(phases, names, statics, objective, linkages, len(joint.values))
    values = tuple(tuple(slots.values) for slots in own)
    return shape, Constants(values, tuple(joint.values))


def _known(phase: Phase, statics: Sequence[str]) -> dict[str, float]:
    """The phase's constants by name."""
    varying = {*phase.states, *phase.controls, *phase.algebraic, *phase.natives, *statics, "t"}
    return {name: value for name, value in phase.parameters.items() if name not in varying}


def _at_ends(known: Mapping[str, float]) -> Callable[[str], float | None]:
    """Constants are the same at both ends."""

    def value_of(name: str) -> float | None:
        return known.get(name.partition(".")[2] if name.startswith(_ENDS) else name)

    return value_of


def _over_phases(
    model: Model, rooms: Sequence[Callable[[str], float | None]]
) -> Callable[[str], float | None]:
    """Constants behind the names of their phases, the longest first; the only one's bare."""
    named = [(f"{phase.name}.", room) for phase, room in zip(model.phases, rooms, strict=True)]
    named.sort(key=lambda one: -len(one[0]))
    named += [("", room) for room in rooms if len(rooms) == 1]
    own = {static.name for static in model.statics}

    @functools.cache  # the same names again and again
    def value_of(name: str) -> float | None:
        if name in own:
            return None
        found = (
            room(name.removeprefix(prefix)) for prefix, room in named if name.startswith(prefix)
        )
        return next((value for value in found if value is not None), None)

    return value_of


def _phase_shape(
    phase: Phase, slots: Slots, known: dict[str, float], statics: tuple[str, ...]
) -> PhaseShape:
    """``known`` gets the intermediates that are made of constants alone."""
    form, expr = phase.form, slots.expr
    asked = {name for one in form.holonomic for name in one.names}
    definitions = []
    for name, tree in form.definitions.items():  # each after what it needs
        found, value = slots.define(tree)
        if value is not None:
            known[name] = value
        if value is None or name in asked or slots.closed:
            definitions.append((name, found))
    derivatives = tuple((name, expr(tree)) for name, tree in form.derivatives.items())
    unknowns = tuple(
        Solved(group.names, tuple(map(expr, group.residuals)), group.labels)
        for group in form.unknowns
    )
    flow = tuple(map(expr, form.flow.values()))
    integrals = tuple((name, expr(tree)) for name, tree in phase.integrals.items())
    path, held, boundary = (
        tuple(expr(row.tree) for row in rows) for rows in (phase.path, phase.held, phase.boundary)
    )
    return PhaseShape(
        states=phase.states,
        controls=phase.controls,
        algebraic=phase.algebraic,
        natives=phase.natives,
        statics=statics,
        constants=len(slots.values),
        definitions=tuple(definitions),
        derivatives=derivatives,
        unknowns=unknowns,
        flow=flow,
        integrals=integrals,
        path=path,
        held=tuple(zip((row.label for row in phase.held), held, strict=True)),
        boundary=boundary,
        holonomic=form.holonomic,
        stepped=_stepped(phase, slots),
    )


def _is_stepped(form: Form) -> bool:
    return form.principle is not None or bool(form.balance)


def _stepped(phase: Phase, slots: Slots) -> Stepped | None:
    form = phase.form
    if not _is_stepped(form):
        return None
    parameters = tuple((name, slots.expr(Name(name))) for name in phase.parameters)
    balance = tuple(map(slots.expr, form.balance.values()))
    return Stepped(form.principle, frozen(form.principle), balance, form.solid, parameters)
