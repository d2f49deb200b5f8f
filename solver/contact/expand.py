"""The problem that is solved in place of the posted one: forces and slacks as controls, pairs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from schemas import resolve
from schemas.expressions import Call, Expression, Name, Number, Tree
from schemas.methods import ContactImplicit
from schemas.phases import Constraint, Phase
from schemas.problem import Objective, Problem, Static
from schemas.stepped import stepped_by
from schemas.urdf import Urdf
from schemas.values import Bound, Scalar
from solver.complementarity import (
    RELAXATION,
    Pair,
    relaxation_cost,
    relaxation_rows,
)
from solver.contact.forces import Forces, forces_of
from solver.hybrid.modes import limited
from solver.lowering import STRETCH
from solver.mechanics.limits import both

EXACT = 1e-6
"""Judges the objective of time steps: sums are recomputed as they are, no integral."""

_COST = "#complementarity"

Discretisation = Literal["discrete_gradient", "backward_euler"]


@dataclass(frozen=True, slots=True)
class Contacts:
    """The problem to solve, and the pairs that are complementary in it.

    ``methods`` has the method of each phase that is stepped through contact, by index.
    """

    problem: Problem
    pairs: tuple[Pair, ...] = ()
    methods: Mapping[int, ContactImplicit] | None = None


def contacts_of(problem: Problem) -> Contacts:
    """Forces as controls, gaps and slips as slacks; a problem without contacts comes back."""
    methods = {
        index: method
        for index, phase in enumerate(problem.phases)
        if (method := stepped_by(problem, phase)) is not None
    }
    if not methods:
        return Contacts(problem)
    phases = list(problem.phases)
    pairs: list[Pair] = []
    costs: list[tuple[str, Tree]] = []
    for index, method in methods.items():
        phase = phases[index]
        found = forces_of(phase, method)
        own = [replace(pair, phase=index) for pair in found.pairs]
        cost = relaxation_cost(method.relaxation.form or "equality", own)
        phases[index] = _with_forces(phase, found, method, own, cost)
        if cost is not None:
            costs.append((phase.name, cost))
        pairs += own
    changed: dict[str, object] = {
        "phases": phases,
        "objective": _objective(problem, [name for name, _ in costs]),
    }
    if pairs:
        value = Scalar(next(iter(methods.values())).relaxation.schedule[0])
        relaxation = Static.model_construct(bounds=Bound(value, value), guess=value)
        changed["static"] = {**problem.static, RELAXATION: relaxation}
    return Contacts(problem.model_copy(update=changed), tuple(pairs), methods)


def as_stepped(problem: Problem) -> Problem:
    """The problem with the choices of contact-implicit methods made.

    Where all phases are stepped, meshes are judged by what steps lose: that is the refinement's
    tolerance then.
    """
    phases = list(problem.phases)
    for index, phase in enumerate(phases):
        method = stepped_by(problem, phase)
        if method is not None:
            phases[index] = phase.model_copy(update={"method": _chosen(method, phase)})
    methods = [one.method for one in phases if isinstance(one.method, ContactImplicit)]
    if not methods:
        return problem
    changed: dict[str, object] = {"phases": phases}
    if len(methods) < len(phases):
        return problem.model_copy(update=changed)
    if problem.refinement is not None:
        allowed = {"tolerance": min(method.dissipation for method in methods)}
        changed["refinement"] = problem.refinement.model_copy(update=allowed)
    if problem.certificate.tolerance is None:
        exact = {"tolerance": EXACT}
        changed["certificate"] = problem.certificate.model_copy(update=exact)
    return problem.model_copy(update=changed)


def _chosen(method: ContactImplicit, phase: Phase) -> ContactImplicit:
    """With what was left out; in space equalities of many directions at one foot often fail."""
    way: Discretisation = method.discretisation or "discrete_gradient"
    usual = "inequality" if isinstance(phase.system, Urdf) else "equality"
    form = method.relaxation.form or usual
    relaxation = method.relaxation.model_copy(update={"form": form})
    return method.model_copy(update={"discretisation": way, "relaxation": relaxation})


def _with_forces(
    phase: Phase,
    found: Forces,
    method: ContactImplicit,
    pairs: Sequence[Pair],
    cost: Tree | None,
) -> Phase:
    bounds = both(phase.bounds, found.bounds, resolve.parameters(phase.system))
    if method.steps == "pairwise":
        shortest, longest = method.step_bounds
        bounds[STRETCH] = Bound(Scalar(shortest), Scalar(longest))
    rows = [
        limited(label, label, tree, (0.0, 0.0))  # each pass has limits of its own
        for label, tree, _ in relaxation_rows(method.relaxation.form or "equality", pairs)
    ]
    integrals = dict(phase.integrals)
    if cost is not None:
        integrals[_COST] = Expression("complementarity", cost)
    return phase.model_copy(
        update={
            "system": found.system,
            "bounds": bounds,
            "path": [*phase.path, *found.rows, *rows],
            "boundary": [*phase.boundary, *_clear(phase, found), *_wrapped(phase, method)],
            "initial": _started(phase, method),
            "integrals": integrals,
        }
    )


def _clear(phase: Phase, found: Forces) -> Iterator[Constraint]:
    """No contact starts inside of anything, where that is not given anyway."""
    fixed = all(name in phase.initial for name in phase.system.state_names[: _half(phase)])
    for gap in () if fixed else found.gaps:
        yield limited(f"start of {gap}", gap, Name(f"initial.{gap}"))
    for names, row in found.starts:
        if not all(name in phase.initial for name in names):
            yield row


def _started(phase: Phase, method: ContactImplicit) -> dict[str, Bound]:
    """Nothing comes before the first step, unless the phase is periodic."""
    if method.steps != "pairwise" or phase.periodic is not None:
        return phase.initial
    mean = Scalar(1.0)
    return {**phase.initial, STRETCH: Bound(mean, mean)}


def _wrapped(phase: Phase, method: ContactImplicit) -> Iterator[Constraint]:
    """In a period the last step comes before the first."""
    if method.steps == "pairwise" and phase.periodic is not None:
        ends = tuple(Name(f"{end}.{STRETCH}") for end in ("initial", "final"))
        yield limited("step before", "step before", Call("-", ends), (0.0, 0.0))


def _half(phase: Phase) -> int:
    return len(phase.system.state_names) // 2


def _objective(problem: Problem, phases: Sequence[str]) -> Objective | None:
    """With what the relaxation's form adds."""
    if not phases:
        return problem.objective
    own = problem.objective.minimize if problem.objective else Expression("0", Number(0.0))
    terms = [Name(f"{name}.{_COST}") for name in phases]
    whole = Call("+", tuple(terms)) if len(terms) > 1 else terms[0]
    tree = Call("+", (own.tree, whole))
    return Objective.model_construct(minimize=Expression(own.text, tree))
