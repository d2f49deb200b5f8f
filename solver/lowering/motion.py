"""What each kind of system says about its motion, in one shape."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import assert_never

from schemas.expressions import Expression, Name, Tree, derivative
from schemas.mechanisms import Mechanism
from schemas.systems import ClosedForm, Ode, SecondOrder, System
from schemas.urdf import Urdf
from solver.lowering.derivations import CannotDerive
from solver.lowering.form import Holonomic
from solver.mechanics import equations_of
from solver.mechanics.spatial import spatial_equations


@dataclass(frozen=True, slots=True)
class Motion:
    """A system's equations.

    Attributes
    ----------
    trees
        What names stand for: intermediates, the highest derivatives that are given, formulas of
        closed forms, and residuals under the names ``rows``, which no user can write.
    derivatives
        The rate of each state.
    rows, implicit, forces
        Of a system with residuals: these, and the coordinates whose accelerations solve them,
        together with forces that hold what is held.
    holonomic
        What the forces hold.
    flow
        The states of a closed form.
    """

    trees: Mapping[str, Tree]
    derivatives: Mapping[str, Tree] = field(default_factory=dict)
    rows: tuple[str, ...] = ()
    implicit: tuple[str, ...] = ()
    forces: tuple[str, ...] = ()
    holonomic: tuple[Holonomic, ...] = ()
    flow: Mapping[str, Tree] = field(default_factory=dict)


def motion_of(system: System) -> Motion:
    """The equations of any system."""
    trees = _trees(system.define)
    match system:
        case Ode():
            derivatives = {name: system.derivatives[name].tree for name in system.states}
            rates = {derivative(name): tree for name, tree in derivatives.items()}
            return Motion(trees | rates, derivatives)
        case SecondOrder():
            derivatives = {name: Name(derivative(name)) for name in system.state_names}
            if system.accelerations is not None:
                given = _trees(system.accelerations)
                accelerations = {derivative(name, 2): tree for name, tree in given.items()}
                return Motion(trees | accelerations, derivatives)
            rows = {f"#dynamics {row}": one.tree for row, one in enumerate(system.residual or [])}
            return Motion(trees | rows, derivatives, tuple(rows), tuple(system.coordinates))
        case Mechanism():
            derivatives = {name: Name(derivative(name)) for name in system.state_names}
            found = equations_of(system)
            implicit = tuple(system.coordinates)
            return Motion(
                trees | found.trees,
                derivatives,
                found.rows,
                implicit,
                found.forces,
                tuple(
                    Holonomic(row.name, row.place, row.rate, row.kind != "tangential")
                    for row in found.held
                ),
            )
        case Urdf():
            return _in_space(system, trees)
        case ClosedForm():
            flow = _trees(system.states)
            return Motion(trees | flow, flow=flow)
        case _:
            assert_never(system)


def _in_space(system: Urdf, trees: Mapping[str, Tree]) -> Motion:
    found = spatial_equations(system)
    if found.dependent:
        raise CannotDerive(
            f"{' and '.join(found.dependent[:2])} cannot be held: other contacts in 'mode' hold it "
            "already, or nothing moves there; hold less, by 'sticking_x' or 'frictionless'"
        )
    return Motion(
        {**trees, **found.trees},
        {name: Name(derivative(name)) for name in system.state_names},
        found.rows,
        tuple(system.coordinates),
        found.forces,
        tuple(Holonomic(one.label, one.place, one.rate, one.anchored) for one in found.held),
    )


def _trees(expressions: Mapping[str, Expression]) -> dict[str, Tree]:
    return {name: expression.tree for name, expression in expressions.items()}
