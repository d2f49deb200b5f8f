"""Expressions over a system's names, ready for numpy: a tape, and derivatives made on demand."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise

from schemas.errors import InvalidModel, Issue
from schemas.expressions import Name, Tree, derivative, names_in, split
from schemas.expressions.differentiation import ONE, total_derivative
from solver.numeric.tape import Scope, Tape, record


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What names mean: numbers, definitions, and those that some source supplies at every point.

    ``definitions`` may be of derivatives: of ``dd(q)``, given accelerations. ``supplied`` says
    whether a name, perhaps a derivative, comes from outside.
    """

    constants: Mapping[str, float]
    definitions: Mapping[str, Tree]
    supplied: Callable[[str], bool]

    def record(
        self, trees: Sequence[Tree], inputs: Sequence[str] = ()
    ) -> tuple[Tape, tuple[str, ...]]:
        """The tape of some expressions, and the names that it takes as inputs, in order.

        ``inputs`` come first, whether they are used or not.

        Raises
        ------
        InvalidModel
            Where a name has no value here: a control's derivative, a force not known yet.
        """
        made = self._derived(trees)
        used = dict.fromkeys(
            name
            for name in _names([*trees, *made.values()])
            if name not in made and name not in self.constants
        )
        for name in used:
            if not self.supplied(name):
                raise InvalidModel([Issue("", f"'{name}' has no value in a simulation")])
        taken = tuple(dict.fromkeys([*inputs, *used]))
        return record(trees, Scope(taken, self.constants, made)), taken

    def _derived(self, trees: Sequence[Tree]) -> dict[str, Tree]:
        """The definitions that expressions need, with derivatives; each after its own needs."""
        made: dict[str, Tree] = {}
        graph: dict[str, list[str]] = {}
        pending = _names(trees)
        while pending:
            name = pending.pop()
            if name in graph or self.supplied(name) or not self._home(name)[0]:
                continue
            used = _names([self._tree(name, made)])
            graph[name] = [one for one in used if not self.supplied(one) and self._home(one)[0]]
            pending += used
        try:
            order = list(TopologicalSorter(graph).static_order())
        except CycleError as error:
            circle = "', '".join(error.args[1])
            raise InvalidModel([Issue("/system", f"'{circle}' define each other")]) from None
        return {name: made[name] for name in order}

    def _tree(self, name: str, made: dict[str, Tree]) -> Tree:
        """What a definition, or the derivative of one, stands for; kept in ``made``."""
        home, above = self._home(name)
        made.setdefault(home, self.definitions[home])
        for before, after in pairwise(derivative(home, k) for k in range(above + 1)):
            if after not in made:
                made[after] = total_derivative(made[before], self._rate)
        return made[name]

    def _home(self, name: str) -> tuple[str, int]:
        """The definition that a name is a derivative of, and of which order; else nothing."""
        _, order, _ = split(name)
        for above in range(order + 1):
            lower = derivative(name, -above)
            if lower in self.definitions:
                return lower, above
        return "", 0

    def _rate(self, base: str) -> Tree | None:
        if base == "t":
            return ONE
        return None if base in self.constants else Name(derivative(base))


def _names(trees: Iterable[Tree]) -> list[str]:
    return [name.name for tree in trees for name in names_in(tree)]
