"""Slope arithmetic: trees over a step, with the exact change of each as a row times the step.

Of every quantity f its values before and after the step, and factors g of those it is made of,
such that ``f1 - f0`` is the sum of ``g`` times their changes: in exact arithmetic, for a step of
any size. Rows over the coordinates follow by the chain rule, which is exact for differences, too:
forward for rates, backward for forces, each at the cost of the quantities themselves. At a step
of length nothing the factors are derivatives.
"""

from collections.abc import Iterable, Mapping, Sequence

import casadi as ca

from schemas.expressions import Call, Name, Number, Tree, names_in
from solver.discrete import differences
from solver.discrete.chord import Chord, Part
from solver.discrete.rules import RULES
from solver.expressions import FUNCTIONS, SX


class Slopes:
    """The quantities of a step.

    Parameters
    ----------
    leaves
        Coordinate -> its value before and after, and its rate: (f1 - f0) / h.
    definitions
        Names over coordinates and constants.
    known
        Constants of the step.
    """

    def __init__(
        self,
        leaves: Mapping[str, tuple[SX, SX, SX]],
        definitions: Mapping[str, Tree],
        known: Mapping[str, SX],
    ) -> None:
        self._parts: list[tuple[Part, ...]] = []
        self._definitions, self._known = definitions, known
        self._trees: dict[Tree, Chord] = {}
        self._named: dict[str, Chord] = {}
        self._turns: dict[int, tuple[Chord, Chord]] = {}
        for name, (before, after, rate) in leaves.items():
            self._named[name] = self._add(before, after, 0.5 * (before + after), rate, ())
        self._leaves = len(self._parts)

    def of(self, tree: Tree) -> Chord:
        """A tree over the step."""
        for name in names_in(tree):
            self._demand(name.name)
        return self._of(tree)

    def pull(self, forces: Iterable[tuple[Chord, SX]]) -> SX:
        """The generalized forces (n_q,) of forces along quantities, by the rows of the step."""
        pulls = [SX(0)] * len(self._parts)
        for chord, force in forces:
            if chord.varies:
                pulls[chord.place] += force
        for place in range(len(pulls) - 1, self._leaves - 1, -1):
            if not pulls[place].is_zero():
                for part, factor in self._parts[place]:
                    pulls[part.place] += factor * pulls[place]
        return ca.vertcat(SX(0, 1), *pulls[: self._leaves])

    def row(self, tree: Tree) -> SX:
        """The row (1, n_q) that gives the change of a tree from that of the coordinates."""
        return self.pull([(self.of(tree), SX(1))]).T

    def constant(self, value: SX) -> Chord:
        """What does not change over the step."""
        return Chord(value, value, value, SX(0))

    def made(self, before: SX, after: SX, parts: Sequence[Part], mean: SX | None = None) -> Chord:
        """A quantity of given values, made of ``parts``."""
        varying = tuple(part for part in parts if part[0].varies)
        if not varying:
            return self.constant(after)
        rate = sum((factor * part.rate for part, factor in varying), SX(0))
        middle = 0.5 * (before + after) if mean is None else mean
        return self._add(before, after, middle, rate, varying)

    def turn(self, angle: Chord) -> tuple[Chord, Chord]:
        """Cosine and sine, by the middle of the angle and half its change."""
        if not angle.varies:
            return self.constant(ca.cos(angle.after)), self.constant(ca.sin(angle.after))
        if angle.place not in self._turns:
            half = 0.5 * (angle.after - angle.before)
            c, s = ca.cos(angle.mean), ca.sin(angle.mean)
            wide, high = ca.cos(half), ca.sin(half)
            share = differences.sinc(half, high)
            cosine = c * wide + s * high, c * wide - s * high
            sine = s * wide - c * high, s * wide + c * high
            spread = self.made(-high, high, [(angle, share)], SX(0))  # changes by 2 sin(half)
            self._turns[angle.place] = (
                self.made(*cosine, [(spread, -s)], c * wide),
                self.made(*sine, [(spread, c)], s * wide),
            )
        return self._turns[angle.place]

    def _add(self, before: SX, after: SX, mean: SX, rate: SX, parts: tuple[Part, ...]) -> Chord:
        self._parts.append(parts)
        return Chord(before, after, mean, rate, len(self._parts) - 1)

    def _demand(self, name: str) -> None:
        """Work a name out, and first what it needs: an explicit stack, for long chains."""
        pending = [name]
        while pending:
            top = pending[-1]
            tree = self._definitions.get(top)
            if top in self._named:
                pending.pop()
            elif tree is None:
                self._named[top] = self.constant(SX(self._known[top]))
            elif missing := [n.name for n in names_in(tree) if n.name not in self._named]:
                pending.extend(missing)
            else:
                self._named[top] = self._of(tree)

    def _of(self, tree: Tree) -> Chord:
        if isinstance(tree, Name):
            return self._named[tree.name]
        if isinstance(tree, Number):
            return self.constant(SX(tree.value))
        if tree not in self._trees:
            self._trees[tree] = self._call(tree)
        return self._trees[tree]

    def _call(self, tree: Call) -> Chord:
        arguments = [self._of(one) for one in tree.arguments]
        if not any(one.varies for one in arguments):
            return self.constant(SX(FUNCTIONS[tree.function](*(one.after for one in arguments))))
        return RULES[tree.function](self, arguments)
