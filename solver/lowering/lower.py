"""Every system as a form: by integrators, algebraic unknowns and definitions."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from schemas import resolve
from schemas.errors import InvalidModel, Issue
from schemas.expressions import Call, Name, Tree, derivative, names_in, stem
from schemas.mechanisms import Mechanism
from schemas.methods import ContactImplicit
from schemas.pointers import pointer
from schemas.problem import Problem
from schemas.stepped import stepped_by
from schemas.systems import SecondOrder, System
from schemas.urdf import Urdf
from solver.lowering.derivations import CannotDerive, Derivations
from solver.lowering.form import Form, Unknowns
from solver.lowering.motion import Motion, motion_of
from solver.lowering.uses import used_series
from solver.mechanics.principle import Principle, principle_of
from solver.mechanics.spatial_principle import spatial_principle

STRETCH = "#stretch"
"""The state that is a step's length over that of the mesh, where the steps of pairs are free."""


def lower(problem: Problem) -> tuple[Form, ...]:
    """Each phase in first-order form.

    Accelerations that are given by residuals become unknowns, and so do their derivatives: a
    differentiated residual is linear in the highest one. A control whose rate is needed becomes a
    state, its rate the control (a chain of integrators, as long as needed).

    Raises
    ------
    InvalidModel
        Where a name is defined by itself.
    """
    return tuple(_guarded(_lower, problem, index) for index in range(len(problem.phases)))


def lower_native(problem: Problem, index: int) -> Form:
    """A second-order phase for a method that differentiates its own curves.

    Coordinates have derivatives to the fourth order and controls to the second; the dynamics are
    residuals over them.

    Raises
    ------
    InvalidModel
        Where a name is defined by itself, or a higher derivative is needed.
    """
    return _guarded(_lower_native, problem, index)


def _guarded(way: Callable[[Problem, int], Form], problem: Problem, index: int) -> Form:
    try:
        return way(problem, index)
    except CannotDerive as error:
        raise InvalidModel([Issue(pointer("phases", index, "system"), str(error))]) from None


def _lower(problem: Problem, index: int) -> Form:
    system = problem.phases[index].system
    constants = resolve.parameters(system)
    whole, method = motion_of(system), stepped_by(problem, problem.phases[index])
    principle = _principle(system, method)
    states, controls = system.state_names, system.control_names
    motion = whole if method is None else _bare(whole, states)
    free, found = {*controls, *whole.forces}, {*motion.implicit}
    known = {*states, *_stretch(method)}

    def is_leaf(name: str) -> bool:
        order, base = stem(name)
        return name in known or base in free or (base in found and order > 1)

    derivations = Derivations(motion.trees, constants, problem.static, is_leaf)
    needed = [*used_series(problem, index), *_names(motion.derivatives.values())]
    needed += _names(motion.flow.values())
    needed += [name for row in motion.holonomic for name in row.names]
    derivations.demand(needed)
    stepped = whole.rows if method is not None and principle is None else ()
    balance = {_label(row): _itself(whole, row) for row in stepped}
    needed += (
        *_names(balance.values()),
        *(_slips(system) if method is not None else ()),
    )  # slips: for guesses
    derivations.demand(needed)
    groups = _unknowns(derivations, motion, needed) if method is None else ()
    needed += _names(row for group in groups for row in group.residuals)
    definitions = derivations.definitions(needed)
    chains = _chains(controls, [*needed, *_names(definitions.values())])
    return Form(
        constants=constants,
        states=(*states, *(name for chain in chains for name in chain[:-1]), *_stretch(method)),
        controls=tuple(chain[-1] for chain in chains),
        definitions=definitions,
        derivatives=_first_order(motion, definitions, chains),
        unknowns=groups,
        balance=balance,
        solid=_solid(system) if method is not None else (),
        flow=motion.flow,
        publish=_publish(system, chains, _stretch(method)) | _forces(motion),
        holonomic=motion.holonomic,
        principle=principle,
    )


def _itself(motion: Motion, row: str) -> Name:
    """A row of the balance; one that holds an acceleration holds its place instead.

    That keeps the norms of quaternions: steps as long as these would let them drift.
    """
    tree = motion.trees[row]
    places = {derivative(one.place, 2): one.place for one in motion.holonomic if one.place}
    return Name(places.get(tree.name, row) if isinstance(tree, Name) else row)


def _stretch(method: ContactImplicit | None) -> tuple[str, ...]:
    """The lengths of steps that share the time of a pair."""
    return (STRETCH,) if method is not None and method.steps == "pairwise" else ()


def _slips(system: System) -> Iterator[str]:
    if isinstance(system, Mechanism):
        yield from (f"contact.{pair}.slip" for pair in system.touching)
    if isinstance(system, Urdf):
        yield from (f"contact.{name}.slip_{axis}" for name in system.touching for axis in "xy")


def _solid(system: System) -> tuple[str, ...]:
    """The gaps of pairs that are not with the ground."""
    if not isinstance(system, Mechanism):
        return ()
    pairs = system.touching.items()
    return tuple(f"contact.{name}.gap" for name, one in pairs if one.against in system.shapes)


def _bare(motion: Motion, states: Sequence[str]) -> Motion:
    """Without rates of velocities, and without what is held."""
    rates = {name: motion.derivatives[name] for name in states[: len(states) // 2]}
    return replace(motion, derivatives=rates, rows=(), forces=(), holonomic=())


def _principle(system: System, method: ContactImplicit | None) -> Principle | None:
    if method is None or method.discretisation != "discrete_gradient":
        return None
    if isinstance(system, Urdf):
        return spatial_principle(system)
    return principle_of(system) if isinstance(system, Mechanism) else None


def _lower_native(problem: Problem, index: int) -> Form:
    system = problem.phases[index].system
    if not isinstance(system, SecondOrder | Mechanism | Urdf):
        raise CannotDerive("a first-order system has no native form")
    constants = resolve.parameters(system)
    motion = motion_of(system)
    q, u = system.coordinates, system.control_names
    states, controls = _orders(q, range(3)), _orders(u, range(2))
    natives = (*_orders(q, range(3, 5)), *_orders(u, [2]))
    leaves = {*states, *controls, *natives}
    derivations = Derivations(motion.trees, constants, problem.static, leaves.__contains__)
    residuals = _residuals(motion, q)
    needed = [*used_series(problem, index), *_names(residuals.values())]
    derivations.demand(needed)
    definitions = derivations.definitions(needed)
    chains = _chains(u, [*needed, *_names(definitions.values())])
    return Form(
        constants=constants,
        states=states,
        controls=controls,
        definitions=definitions,
        derivatives={},
        natives=natives,
        residuals=residuals,
        publish=_publish(system, chains),
    )


def _names(trees: Iterable[Tree]) -> list[str]:
    return [name.name for tree in trees for name in names_in(tree)]


def _orders(names: Sequence[str], orders: Iterable[int]) -> tuple[str, ...]:
    """The derivatives of all names, order by order."""
    return tuple(derivative(name, order) for order in orders for name in names)


def _unknowns(
    derivations: Derivations, motion: Motion, needed: Sequence[str]
) -> tuple[Unknowns, ...]:
    """Accelerations from the residuals, and as many derivatives of both as are needed."""
    if not motion.implicit:
        return ()
    groups = []
    highest = _settled(motion, derivations.all_names(needed))
    for order in range(2, highest + 1):
        rows = [derivative(row, order - 2) for row in motion.rows]
        derivations.demand(rows)
        trees = tuple(derivations.trees(rows))
        inside = _settled(motion, derivations.all_names(_names(trees)))
        if inside > order:
            raise CannotDerive(f"the residuals need derivatives of order {inside - order + 2}")
        names = _orders(motion.implicit, [order]) + _orders(motion.forces, [order - 2])
        groups.append(Unknowns(names, trees, tuple(_label(row) for row in rows)))
    return tuple(groups)


def _label(row: str) -> str:
    return row.replace("#", "", 1)


def _settled(motion: Motion, names: Iterable[str]) -> int:
    """The highest order of accelerations that are needed; forces come with them."""
    names = list(names)
    return max(_highest(motion.implicit, names), 2 + _highest(motion.forces, names, default=-2))


def _highest(bases: Iterable[str], names: Iterable[str], default: int = 0) -> int:
    wanted = set(bases)
    return max((order for order, base in map(stem, names) if base in wanted), default=default)


def _chains(controls: Sequence[str], names: Sequence[str]) -> list[tuple[str, ...]]:
    """For each control its derivatives, from none to the highest that is used."""
    highest = dict.fromkeys(controls, 0)
    for order, base in map(stem, dict.fromkeys(names)):
        if order > highest.get(base, order):
            highest[base] = order
    return [_orders([u], range(order + 1)) for u, order in highest.items()]


def _first_order(
    motion: Motion, definitions: Mapping[str, Tree], chains: Iterable[tuple[str, ...]]
) -> dict[str, Tree]:
    """The rate of every state; by name where that is a definition already."""
    rates: dict[str, Tree] = {}
    for name, tree in motion.derivatives.items():
        rate = derivative(name)
        rates[name] = Name(rate) if rate in definitions else tree
    for chain in chains:
        rates |= {name: Name(rate) for name, rate in pairwise(chain)}
    return rates


def _residuals(motion: Motion, coordinates: Sequence[str]) -> dict[str, Tree]:
    """What is zero along the motion, label -> tree."""
    if motion.rows:
        return {_label(row): motion.trees[row] for row in motion.rows}
    accelerations = {name: derivative(name, 2) for name in coordinates}
    return {
        f"dynamics {name}": Call("-", (Name(rate), motion.trees[rate]))
        for name, rate in accelerations.items()
    }


def _forces(motion: Motion) -> dict[str, tuple[str, ...]]:
    return {"forces": motion.forces} if motion.forces else {}


def _publish(
    system: System, chains: Iterable[tuple[str, ...]], more: tuple[str, ...] = ()
) -> dict[str, tuple[str, ...]]:
    return {
        "states": (*system.state_names, *more),
        "controls": tuple(system.control_names),
        "rates": tuple(name for chain in chains for name in chain[1:]),
    }
