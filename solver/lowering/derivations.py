"""Names and what they stand for: intermediates, and derivatives to any order that is asked for."""

from collections.abc import Callable, Iterable, Mapping
from graphlib import TopologicalSorter

from schemas.expressions import Name, Number, Tree, derivative, names_in
from schemas.expressions.differentiation import ONE, total_derivative
from solver.lowering.pieces import Cutter

_ENDS = ("initial.", "final.")


class CannotDerive(ValueError):
    """A name that is defined by itself, or that has no such derivative."""


class Derivations:
    """Finds a tree for every name, by differentiation where it has none.

    Parameters
    ----------
    trees
        What is given: name -> tree. A name that is a leaf, too, is differentiated by its tree.
    constants
        Parameters, as numbers.
    fixed
        Further names that do not change over time.
    is_leaf
        Whether a name needs no tree: it varies by itself, along the phase.
    """

    def __init__(
        self,
        trees: Mapping[str, Tree],
        constants: Mapping[str, float],
        fixed: Iterable[str],
        is_leaf: Callable[[str], bool],
    ) -> None:
        self._trees = dict(trees)
        self._constants = constants
        self._fixed = {*constants, *fixed}
        self._varies = is_leaf
        self._done: set[str] = set()

    def trees(self, names: Iterable[str]) -> list[Tree]:
        """What names stand for that were demanded."""
        return [self._trees[name] for name in names]

    def demand(self, names: Iterable[str]) -> None:
        """Find trees for ``names`` and for all that they need.

        An explicit stack: chains of intermediates may be longer than Python's own.

        Raises
        ------
        CannotDerive
            Where a name is defined by itself, or ends with its highest derivative.
        """
        pending, opened = list(names), set[str]()
        while pending:
            top = pending[-1]
            needed = [] if top in self._done else self._needed(top)
            if not needed:
                self._done.add(pending.pop())
                continue
            opened.add(top)
            if circle := [one for one in needed if one in opened]:
                raise CannotDerive(f"'{circle[0]}' is defined by itself, by way of '{top}'")
            pending.extend(needed)

    def definitions(self, names: Iterable[str]) -> dict[str, Tree]:
        """What ``names`` stand for and all that this needs, each after what it needs itself."""
        graph = self._graph(names)
        ordered = TopologicalSorter(graph).static_order()
        return {name: self._trees[name] for name in ordered if not self.is_leaf(name)}

    def all_names(self, names: Iterable[str]) -> list[str]:
        """``names`` and all that they need, leaves too."""
        return list(self._graph(names))

    def _graph(self, names: Iterable[str]) -> dict[str, list[str]]:
        """Names and what each needs itself; nothing for leaves."""
        graph: dict[str, list[str]] = {}
        pending = list(names)
        while pending:
            name = pending.pop()
            if name not in graph:
                tree = None if self.is_leaf(name) else self._trees[name]
                used = [] if tree is None else [one.name for one in names_in(tree)]
                graph[name] = list(dict.fromkeys(used))
                pending.extend(graph[name])
        return graph

    def is_leaf(self, name: str) -> bool:
        """Whether a name needs no tree of its own."""
        return name == "t" or self._settled(name) or self._varies(name)

    def _settled(self, name: str) -> bool:
        """Whether a name does not change over time: a constant, or a value at an end."""
        return name in self._fixed or name.startswith(_ENDS)

    def _needed(self, name: str) -> list[str]:
        """What must be done before ``name`` is; its tree is made as soon as that is possible."""
        if self.is_leaf(name):
            return []
        if name not in self._trees:
            before = derivative(name, -1)
            if before not in self._done:
                return [before]
            if before not in self._trees:
                raise CannotDerive(f"there is no '{name}'; '{before}' is the highest")
            if missing := self._differentiate(before, name):
                return missing
        used = {used.name: None for used in names_in(self._trees[name])}
        return [one for one in used if one not in self._done and not self.is_leaf(one)]

    def _differentiate(self, before: str, name: str) -> list[str]:
        """Make the tree of ``name``, the rate of ``before``; else say what is missing for it."""
        missing: list[str] = []

        def rate(base: str) -> Tree | None:
            if base == "t":
                return ONE
            if self._settled(base):
                return None
            following = derivative(base)
            if self.is_leaf(following):
                return Name(following)
            if following not in self._done:
                missing.append(following)
                return None
            known = self._trees[following]
            return known if isinstance(known, Number) else Name(following)

        self._cut(before)
        tree = total_derivative(self._trees[before], rate)
        if not missing:
            self._trees[name] = tree
        return missing

    def _cut(self, name: str) -> None:
        cutter = Cutter(name, self._constants)
        self._trees[name] = cutter.cut(self._trees[name])
        self._trees |= cutter.pieces
        self._done |= set(cutter.pieces)
