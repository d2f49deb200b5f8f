"""Large expressions cut into named pieces, so that their derivatives grow with their length only.

The rate of a quotient repeats its arguments; of a product, all its factors for each. Where these
are names, that costs nothing. A piece is called ``w#0_1``, as no user can call anything: the
first one of the name ``w`` with no derivative taken yet.
"""

from collections.abc import Mapping

from schemas.expressions import Call, ExpressionError, Name, Number, Tree, constant, names_in, split

_LARGEST = 12
"""Nodes of an argument that is not cut off: smaller ones make more definitions, larger ones
larger derivatives; of 8 to 24 this lowered the hardest expressions fastest."""
_FACTORS = 6
"""Factors of a product that is not cut up."""


class Cutter:
    """Cuts one expression; ``pieces`` holds what was cut off, innermost first."""

    def __init__(self, name: str, constants: Mapping[str, float]) -> None:
        self.pieces: dict[str, Tree] = {}
        prefix, order, base = split(name)
        self._name = f"{prefix}{base}#{order}_"
        self._constants = constants

    def cut(self, tree: Tree) -> Tree:
        """The tree with names in place of its large arguments, and numbers as exponents."""
        return self._small(tree)[0]

    def _small(self, tree: Tree) -> tuple[Tree, int]:
        """The tree and its size, its arguments small."""
        if not isinstance(tree, Call):
            return tree, 1
        if tree.function == "^" and (exponent := self._value(tree.arguments[1])) is not None:
            tree = Call("^", (tree.arguments[0], exponent), tree.column)
        arguments, size = [], 1
        for argument in tree.arguments:
            small, nodes = self._small(argument)
            if nodes > _LARGEST:
                small, nodes = self._piece(small), 1
            arguments.append(small)
            size += nodes
        if tree.function == "*":
            while len(arguments) > _FACTORS:
                chunk = Call("*", tuple(arguments[:_FACTORS]), tree.column)
                arguments = [*arguments[_FACTORS:], self._piece(chunk)]
        return Call(tree.function, tuple(arguments), tree.column), size

    def _piece(self, tree: Tree) -> Tree:
        name = f"{self._name}{len(self.pieces) + 1}"
        self.pieces[name] = tree
        return Name(name)

    def _value(self, exponent: Tree) -> Tree | None:
        """The number behind an exponent over parameters: powers of 0 need it known."""
        if any(name.name not in self._constants for name in names_in(exponent)):
            return None
        try:
            return Number(constant(exponent, self._constants))
        except ExpressionError:
            return None
