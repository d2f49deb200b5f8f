"""Expressions over a form's names, evaluated along a phase and at its ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from schemas.expressions import Name, Tree
from solver.lowering.form import Form
from solver.numeric.curves import PhaseCurves
from solver.numeric.tape import Array, Scope, Tape, record
from solver.numeric.unknowns import Solve

NONE: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Along:
    """Expressions over time, states and controls; a rate per state where made by ``dynamics``.

    ``solves`` finds the unknowns that the expressions need, of which there are ``unknowns``.
    """

    tape: Tape
    solves: tuple[Solve, ...]
    unknowns: int

    def __call__(self, t: Array | float, x: Array, u: Array) -> Array:
        """Values (expressions, ...) at times (...), states (n_x, ...) and controls (n_u, ...)."""
        inputs: list[Any] = [t, *x, *u, *[np.nan] * self.unknowns]
        for solve in self.solves:
            found = solve(inputs, np.shape(t))
            inputs[solve.first : solve.first + len(found)] = found
        return self.tape(inputs, np.shape(t))


def along(form: Form, trees: Sequence[Tree], given: Mapping[str, float] = NONE) -> Along:
    """Make expressions over a form's names ready; constants are folded in.

    ``given`` are numbers beside the form's own: the statics, and the start of a closed form.
    """
    fixed = ["t", *form.states, *form.controls]
    scope = Scope([*fixed, *form.algebraic], {**form.constants, **given}, form.definitions)
    tape = record(trees, scope)
    solves: list[Solve] = []
    reads, first = tape.reads, len(fixed) + len(form.algebraic)
    for group in reversed(form.unknowns):
        first -= len(group.names)
        if not reads.isdisjoint(range(first, first + len(group.names))):
            solves.insert(0, Solve(record(group.residuals, scope), first))
            reads |= solves[0].residuals.reads
    return Along(tape, tuple(solves), len(form.algebraic))


def named(form: Form, names: Sequence[str], given: Mapping[str, float] = NONE) -> Along:
    """Names of a form, be they states, controls, definitions or unknowns."""
    return along(form, [Name(name) for name in names], given)


def dynamics(form: Form, given: Mapping[str, float] = NONE) -> Along:
    """The time derivatives of the states, in the states' order; not for closed forms."""
    return along(form, [form.derivatives[name] for name in form.states], given)


def flow(form: Form, curves: PhaseCurves, given: Mapping[str, float] = NONE) -> Along:
    """The states of a closed form, in their order, from where its own curves start."""
    trees = [form.flow[name] for name in form.states]
    return along(form, trees, {**given, **departure(form, curves)})


def departure(form: Form, curves: PhaseCurves) -> dict[str, float]:
    """``initial.NAME`` of a closed form, whose expressions may use it; else nothing."""
    if not form.flow:
        return {}
    values = [curves.breaks[0], *curves.knots()[:, 0]]
    names = ["t", *form.states]
    return {f"initial.{name}": float(value) for name, value in zip(names, values, strict=True)}


def evaluate(tree: Tree, values: Mapping[str, float]) -> float:
    """One expression over named numbers, such as an objective; NaN where it has no value."""
    return float(record([tree], Scope((), values))((), ())[0])
