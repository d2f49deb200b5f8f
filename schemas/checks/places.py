"""Where expressions stand in a problem, and which names each of them sees."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from schemas.expressions import Expression, split, stem
from schemas.expressions.names import MAX_ORDER
from schemas.mechanisms import Mechanism
from schemas.mechanisms.contacts import HEIGHT_NAME
from schemas.phases import Phase
from schemas.pointers import Part
from schemas.problem import Problem
from schemas.systems import ClosedForm
from schemas.urdf import Urdf


@dataclass(frozen=True, slots=True)
class Scope:
    """The names that an expression sees, each with the highest order of its derivatives."""

    orders: dict[str, int]

    def __contains__(self, name: str) -> bool:
        prefix, order, base = split(name)
        return self.orders.get(prefix + base, -1) >= order

    @property
    def words(self) -> list[str]:
        """The names without their derivatives, those of few parts first."""
        return sorted(self.orders, key=lambda word: (word.count("."), word))


@dataclass(frozen=True, slots=True)
class Place:
    """One expression: the way to it, and the names in its scope (valid until the next place)."""

    parts: tuple[Part, ...]
    expression: Expression
    visible: Scope
    phase: Phase | None


def places(problem: Problem) -> Iterator[Place]:
    """Every expression that is not a constant, in the order of the document."""
    for index, phase in enumerate(problem.phases):
        root = ("phases", index)
        yield from _of_system(problem, phase, (*root, "system"))
        along = Scope(_constant(problem, phase) | {"t": 0} | varying(phase))
        for number, constraint in enumerate(phase.path):
            parts = (*root, "path", number, "expression")
            yield Place(parts, constraint.expression, along, phase)
        for name, expression in phase.integrals.items():
            yield Place((*root, "integrals", name), expression, along, phase)
        ends = at_ends(problem, phase)
        for number, constraint in enumerate(phase.boundary):
            parts = (*root, "boundary", number, "expression")
            yield Place(parts, constraint.expression, ends, phase)
    only = problem.phases[0] if len(problem.phases) == 1 else None
    scope = at_problem(problem)
    for number, constraint in enumerate(problem.linkages):
        yield Place(("linkages", number, "expression"), constraint.expression, scope, only)
    if problem.objective is not None:
        yield Place(("objective", "minimize"), problem.objective.minimize, scope, only)


def at_ends(problem: Problem, phase: Phase) -> Scope:
    """The names of a boundary constraint: ends, duration, integrals, what is constant."""
    series = {"t": 0} | varying(phase)
    ends = {f"{end}.{name}": series[name] for end in ("initial", "final") for name in series}
    plain = dict.fromkeys(["duration", *phase.integrals], 0)
    return Scope(plain | ends | _constant(problem, phase))


def at_problem(problem: Problem) -> Scope:
    """The names of objective and linkages: those of every phase's ends, the phase in front.

    A problem of one phase sees them without the phase, too.
    """
    seen = dict.fromkeys(problem.static, 0)
    for phase in problem.phases:
        names = at_ends(problem, phase).orders
        seen |= {f"{phase.name}.{name}": names[name] for name in names.keys() - problem.static}
        if len(problem.phases) == 1:
            seen |= names
    return Scope(seen)


def variables(phase: Phase) -> dict[str, int]:
    """States or coordinates, then controls, each with the highest order of its derivatives."""
    states = [name for name in phase.system.state_names if not stem(name)[0]]
    return _orders(phase, [*states, *phase.system.control_names])


def limited(phase: Phase) -> dict[str, int]:
    """What bounds and ends may be given for: variables, and names that a mechanism defines."""
    own = phase.system.defined if isinstance(phase.system, Mechanism | Urdf) else {}
    return variables(phase) | own


def varying(phase: Phase) -> dict[str, int]:
    """Variables and intermediates, each with the highest order of its derivatives."""
    return limited(phase) | _orders(phase, phase.system.define)


def _orders(phase: Phase, names: Iterable[str]) -> dict[str, int]:
    """A motion in closed form has no equations to take derivatives from."""
    return dict.fromkeys(names, 0 if isinstance(phase.system, ClosedForm) else MAX_ORDER)


def _constant(problem: Problem, phase: Phase) -> dict[str, int]:
    return dict.fromkeys([*problem.static, *phase.system.parameters], 0)


def _of_system(problem: Problem, phase: Phase, root: tuple[Part, ...]) -> Iterator[Place]:
    """Intermediates, each of which sees those before it, and the equations of motion."""
    system = phase.system
    seen = Scope(_constant(problem, phase) | {"t": 0})
    if isinstance(system, Mechanism | Urdf):
        yield from _of_mechanism(problem, phase, system, root)
        seen.orders.update(limited(phase))
    if isinstance(system, ClosedForm):
        seen.orders.update((f"initial.{name}", 0) for name in ("t", *system.states))
    else:
        seen.orders.update(variables(phase))
    for name, expression in system.define.items():
        yield Place((*root, "define", name), expression, seen, phase)
        seen.orders.update(_orders(phase, [name]))
    for parts, _, expression in system.equations():
        yield Place((*root, *parts), expression, seen, phase)


def _of_mechanism(
    problem: Problem, phase: Phase, system: Mechanism | Urdf, root: tuple[Part, ...]
) -> Iterator[Place]:
    """What does not change over time: over parameters and statics; heights over x, too."""
    constant = Scope(_constant(problem, phase))
    over_ground = Scope(_constant(problem, phase) | {HEIGHT_NAME: 0})
    for parts, expression in system.constants():
        high = parts[0] == "surfaces" and parts[-1] == "height"
        yield Place((*root, *parts), expression, over_ground if high else constant, phase)
