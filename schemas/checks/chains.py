"""Derivatives in time: what each is made of, that none needs itself, and how high it reaches.

A derivative ``d(x)`` stands for the total derivative of an expression, which needs derivatives of
the names in there, and so on: a chain that ends at states, or at derivatives of controls.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from schemas.checks.places import places
from schemas.errors import Issue
from schemas.expressions import Expression, derivative, names_in, stem
from schemas.expressions.names import MAX_ORDER
from schemas.mechanisms import Mechanism, motor_control
from schemas.methods import DirCol5i
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm, Ode, SecondOrder, System
from schemas.urdf import Urdf, motor_torque

_DEEPEST = 3 * MAX_ORDER
"""Orders that a chain may pass on its way, as for ``dddd(y)`` where y is ``dddd(x)``."""
_CUBIC = 2
"""Derivatives of controls that `DirCol5i` has."""
_RESIDUAL = "#"
_ENDS = ("initial.", "final.")


class Node(NamedTuple):
    """A name that varies under a derivative, of order 0 and up."""

    base: str
    order: int

    def __str__(self) -> str:
        if self.order > MAX_ORDER:
            return f"derivative {self.order} of {self.base}"
        return derivative(self.base, self.order)


class Where(NamedTuple):
    """Where a name is written."""

    parts: tuple[Part, ...]
    column: int | None = None


def check(problem: Problem) -> Iterator[Issue]:
    """Chains that lead back to where they start, and those that end too high."""
    names = written(problem)
    for index, phase in enumerate(problem.phases):
        circles = list(_circles(phase.system, ("phases", index, "system")))
        yield from circles
        if not circles:
            method = phase.method or problem.method
            yield from _too_high(phase.system, names[index], native=isinstance(method, DirCol5i))


class Chains:
    """What derivatives are made of.

    An equation gives a name at some order (a state at 1, a coordinate at 2, an intermediate at
    0) over names of its own; an order more of the one needs an order more of the others. With
    ``native``, coordinates stand for themselves at every order.
    """

    def __init__(self, system: System, *, native: bool) -> None:
        self._made: dict[str, tuple[int, list[Node]]] = {}
        for name, one in system.define.items():  # those further down are refused elsewhere
            earlier = [
                n for n in nodes_in([one]) if n.base in self._made or n.base not in system.define
            ]
            self._made[name] = 0, earlier
        if isinstance(system, Mechanism | Urdf):
            self._made |= _of_mechanism(system, native=native)
        elif isinstance(system, Ode):
            self._made |= {name: (1, nodes_in([one])) for name, one in system.derivatives.items()}
        elif isinstance(system, SecondOrder) and not native:
            given = system.accelerations or {}
            self._made |= {name: (2, nodes_in([one])) for name, one in given.items()}
            if system.residual is not None:
                self._made[_RESIDUAL] = (0, nodes_in(system.residual))
                for name in system.coordinates:
                    self._made[name] = (2, [Node(_RESIDUAL, 0)])

    def made_of(self, node: Node) -> list[Node]:
        """What a name is made of itself; nothing where it stands for itself."""
        given, nodes = self._made.get(node.base, (_DEEPEST, []))
        if not given <= node.order < _DEEPEST:
            return []
        return [Node(base, order + node.order - given) for base, order in nodes]

    def reached(self, roots: Iterable[Node]) -> Iterator[tuple[Node, Node]]:
        """Everything that the roots are made of, themselves included, each with one root."""
        pending = [(root, root) for root in roots]
        seen = set(roots)
        while pending:
            node, root = pending.pop()
            yield node, root
            for one in self.made_of(node):
                if one not in seen:
                    seen.add(one)
                    pending.append((one, root))

    def circle(self, start: Node, done: set[Node]) -> list[Node]:
        """A way from ``start`` to a name that is on the way already, at this order or a lower one.

        Empty where there is none; ``done`` collects what leads to no circle.
        """
        way, branches = [start], [iter(self.made_of(start))]
        while way:
            node = next(branches[-1], None)
            if node is None:
                done.add(way.pop())
                branches.pop()
            elif node not in done and self._given(node.base) <= node.order:
                if self._given(node.base):  # an intermediate leads back by way of another only
                    for place, before in enumerate(way):
                        if before.base == node.base and before.order <= node.order:
                            return [*way[place:], node]
                way.append(node)
                branches.append(iter(self.made_of(node)))
        return []

    def _given(self, base: str) -> int:
        """The order from which on a name is made of others."""
        return self._made[base][0] if base in self._made else _DEEPEST


def nodes_in(expressions: Iterable[Expression]) -> list[Node]:
    """The names of expressions, each once; values at ends do not vary."""
    names = (name.name for one in expressions for name in names_in(one.tree))
    parts = (stem(name) for name in names if not name.startswith(_ENDS))
    return list(dict.fromkeys(Node(base, order) for order, base in parts))


def _of_mechanism(system: Mechanism | Urdf, *, native: bool) -> dict[str, tuple[int, list[Node]]]:
    """All accelerations together are made of all controls; other names of coordinates."""
    first = system.coordinates[:1]  # one stands for all: they have the same derivatives
    controls = [Node(name, 0) for name in system.control_names]
    pushing = nodes_in(expression for _, _, expression in system.equations())
    made: dict[str, tuple[int, list[Node]]] = {
        name: (0, [Node(one, MAX_ORDER - order) for one in first])
        for name, order in system.defined.items()
    }
    for name, control in _drives(system).items():
        for word in (f"motor.{name}.torque", f"motor.{name}.power"):
            if word in made:
                made[word][1].append(Node(control, 0))
    if not native:
        made[_RESIDUAL] = 0, [*controls, *pushing]
        made |= {name: (2, [Node(_RESIDUAL, 0)]) for name in system.coordinates}
    return made


def _drives(system: Mechanism | Urdf) -> dict[str, str]:
    """Motors and their controls."""
    if isinstance(system, Urdf):
        return {name: motor_torque(name) for name in system.motor_joints}
    return {name: motor_control(name, motor) for name, motor in system.motors.items()}


def _circles(system: System, place: tuple[Part, ...]) -> Iterator[Issue]:
    """Equations of motion that need what they give."""
    if isinstance(system, Mechanism | Urdf):
        equations = [(parts, one) for parts, _, one in system.equations()]
        yield from _high_residuals(system, equations, place)
        return
    if isinstance(system, SecondOrder) and system.residual is not None:
        rows = enumerate(system.residual)
        yield from _high_residuals(system, [(("residual", i), one) for i, one in rows], place)
        return
    order = 1 if isinstance(system, Ode) else 2
    chains, done = Chains(system, native=False), set[Node]()
    for parts, _, _ in system.equations():
        way = chains.circle(Node(str(parts[-1]), order), done)
        if way:
            yield Issue(
                pointer(*place, *parts),
                f"{way[0]} needs itself: " + _told(way),
                "write one of them out; what gives accelerations only together is a 'residual' of "
                "a second_order system",
            )
            return


def _told(way: list[Node]) -> str:
    return f"{way[0]} needs " + ", which needs ".join(map(str, way[1:]))


def _high_residuals(
    system: SecondOrder | Mechanism | Urdf,
    residual: list[tuple[tuple[Part, ...], Expression]],
    place: tuple[Part, ...],
) -> Iterator[Issue]:
    chains = Chains(system, native=True)
    what = "a residual" if isinstance(system, SecondOrder) else "a force"
    for parts, expression in residual:
        for node, root in chains.reached(nodes_in([expression])):
            if node.base in system.coordinates and node.order > 2:
                through = "" if node == root else f" (by way of {root})"
                yield Issue(
                    pointer(*place, *parts),
                    f"{what} settles accelerations, but this one needs {node}{through}",
                    f"use dd({node.base}) at the most",
                )
                break


def _too_high(system: System, roots: Mapping[Node, Where], *, native: bool) -> Iterator[Issue]:
    """Derivatives over those that a method can have."""
    if isinstance(system, ClosedForm):
        return
    chains, told = Chains(system, native=native), set[Node]()
    most = dict.fromkeys(system.control_names, _CUBIC if native else MAX_ORDER)
    if native and isinstance(system, SecondOrder | Mechanism | Urdf):
        most |= dict.fromkeys(system.coordinates, MAX_ORDER)
    for node, root in chains.reached(roots):
        limit = most.get(node.base, _DEEPEST - 1)
        if node.order > limit and root not in told:
            told.add(root)
            parts, column = roots[root]
            needs = "" if node == root else f" needs {node}, and that"
            message = f"{root}{needs} is too high: {node.base} has {limit} derivatives here"
            hint = "every other method has more" if native else "use a lower derivative"
            yield Issue(pointer(*parts), message, hint, column)


def _without_end(name: str) -> str:
    head, _, rest = name.partition(".")
    return rest if f"{head}." in _ENDS else name


def written(problem: Problem) -> list[dict[Node, Where]]:
    """For each phase the names that are written of it, each where it is first."""
    found: list[dict[Node, Where]] = [{} for _ in problem.phases]
    phases = {phase.name: index for index, phase in enumerate(problem.phases)}
    for place in places(problem):
        for name in names_in(place.expression.tree):
            head, _, rest = name.name.partition(".")
            index = phases.get(head, 0 if place.phase else None)
            inside = rest if head in phases else name.name
            if place.parts[0] == "phases":
                index, inside = int(place.parts[1]), name.name
            if index is not None:
                order, base = stem(_without_end(inside))
                found[index].setdefault(Node(base, order), Where(place.parts, name.column))
    for index, phase in enumerate(problem.phases):
        for field in ("bounds", "initial", "final"):
            for name in getattr(phase, field):
                order, base = stem(name)
                where = Where(("phases", index, field, name))
                found[index].setdefault(Node(base, order), where)
    return found
