"""Expressions of one phase, said of its parts."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from schemas.expressions import Call, Expression, Name, Tree


@dataclass(frozen=True, slots=True)
class Renaming:
    """What the names of a phase's ends mean once it is split.

    Attributes
    ----------
    prefixes
        How the phase is written in front of a name: ``swing.``; also nothing, where the
        expression stands in the phase, or where there is no other.
    parts
        The names of the parts, in order.
    integrals
        The names of the phase's integrals.
    statics
        The problem's own names, which stay.
    """

    prefixes: tuple[str, ...]
    parts: Sequence[str]
    integrals: Collection[str]
    statics: Collection[str]

    def expression(self, expression: Expression) -> Expression:
        """The user's text with the tree rewritten."""
        return Expression(expression.text, self.tree(expression.tree))

    def tree(self, tree: Tree) -> Tree:
        """The tree over the parts' names.

        The initial values are the first part's, the final ones the last part's; integrals are
        sums over the parts, and the duration runs from the first to the last.
        """
        if isinstance(tree, Call):
            arguments = tuple(self.tree(argument) for argument in tree.arguments)
            return Call(tree.function, arguments, tree.column)
        return self._name(tree) if isinstance(tree, Name) else tree

    def _name(self, name: Name) -> Tree:
        bare = self._bare(name.name)
        if bare is None:
            return name
        first, last = self.parts[0], self.parts[-1]
        if bare == "duration":
            ends = (Name(f"{last}.final.t", name.column), Name(f"{first}.initial.t", name.column))
            return Call("-", ends, name.column)
        if bare in self.integrals:
            terms = tuple(Name(f"{part}.{bare}", name.column) for part in self.parts)
            return Call("+", terms, name.column) if len(terms) > 1 else terms[0]
        return Name(f"{last if bare.startswith('final.') else first}.{bare}", name.column)

    def _bare(self, name: str) -> str | None:
        """The name as the phase itself knows it; None where it is not the phase's."""
        if name in self.statics:
            return None
        for prefix in sorted(self.prefixes, key=len, reverse=True):
            if name.startswith(prefix):
                return name[len(prefix) :]
        return None
