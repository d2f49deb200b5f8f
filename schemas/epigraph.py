"""Absolute values, ``min`` and ``max`` in integrals, exactly: by slacks that the optimum presses.

``abs(e)`` becomes a new name s with rows s - e >= 0 and s + e >= 0 along the phase (003, section
7.10.5, with the two slacks there made one). At an optimum s is ``abs(e)`` if the objective rises
with s, so that is what is asked of a problem here.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from schemas.errors import Issue
from schemas.expressions import Call, Name, Tree, names_in
from schemas.expressions.monotone import Obstacle, Replacement, replaced, without_columns
from schemas.expressions.signs import Sign
from schemas.expressions.smoothing import NONSMOOTH
from schemas.known_signs import KnownSigns
from schemas.methods import MultipleShooting
from schemas.pointers import Part, pointer
from schemas.problem import Problem
from schemas.systems import ClosedForm

_SMOOTH = 'smooth it: write "nonsmooth": {"abs": {"tanh": 0.01}}'
_MOST_INLINED = 500


@dataclass(slots=True)
class Epigraph:
    """A phase's integrals with slacks in them.

    Attributes
    ----------
    values
        Slack -> what it is at the optimum, over names of the phase and earlier slacks. No user
        can write a slack's name.
    rows
        Label -> tree that is never negative along the phase.
    integrals
        Integral -> its integrand with slacks in place; only those that have any.
    issues
        Why it cannot be done.
    """

    values: dict[str, Tree] = field(default_factory=dict)
    rows: dict[str, Tree] = field(default_factory=dict)
    integrals: dict[str, Tree] = field(default_factory=dict)
    issues: list[Issue] = field(default_factory=list)


def epigraph(problem: Problem, index: int) -> Epigraph:
    """The slacks of a phase, for what of its integrals enters the objective."""
    return _Reader(problem, index).read()


@dataclass(frozen=True, slots=True)
class _Use:
    """Where the phase's integrals are used: the objective must press slacks, rows must not pull.

    ``rises`` is None where neither more nor less of an integral is harmless.
    """

    parts: tuple[Part, ...]
    tree: Tree
    rises: bool | None


class _Reader:
    """Reads one phase of a problem whose names have been checked."""

    def __init__(self, problem: Problem, index: int) -> None:
        self.problem, self.index = problem, index
        self.phase = problem.phases[index]
        self.signs = KnownSigns(problem)
        self.define = {name: one.tree for name, one in self.phase.system.define.items()}
        self.by = Replacement(self._is_part, self._replace, self._sign)
        self.rough: set[str] = set()
        for name, tree in self.define.items():
            if self.by.concerns(tree):
                self.rough.add(name)
        self.result = Epigraph()
        self.slacks: dict[Tree, Name] = {}
        self.inlined = 0

    def read(self) -> Epigraph:
        integrals = {name: one.tree for name, one in self.phase.integrals.items()}
        rough = [name for name, tree in integrals.items() if self.by.concerns(tree)]
        towards = self._towards(rough)
        if not towards or not self._supported(next(iter(towards))):
            return self.result
        for name, rises in towards.items():
            try:
                self.result.integrals[name] = replaced(integrals[name], self.by, rises=rises)
            except Obstacle as obstacle:
                self._refuse(("phases", self.index, "integrals", name), obstacle)
        return self.result

    def _refuse(self, parts: tuple[Part, ...], obstacle: Obstacle) -> None:
        message = f"no slack can take the place of abs, min or max: {obstacle.message}"
        self.result.issues.append(Issue(pointer(*parts), message, _SMOOTH, obstacle.column))

    def _supported(self, name: str) -> bool:
        """Whether a slack has values along the phase."""
        reason = ""
        if isinstance(self.phase.system, ClosedForm):
            reason = "a motion in closed form has no nodes for it"
        elif isinstance(self.phase.method or self.problem.method, MultipleShooting):
            reason = "multiple shooting integrates between its knots, where a slack has no value"
        if reason:
            self._refuse(("phases", self.index, "integrals", name), Obstacle(reason, None))
        return not reason

    # What the objective and the rows over ends do with the integrals.

    def _towards(self, rough: list[str]) -> dict[str, bool]:
        """The integrals of the objective, and whether it rises with each of them."""
        if self.problem.objective is None:
            return {}
        use = _Use(("objective", "minimize"), self.problem.objective.minimize.tree, True)
        towards = self._found(use, rough)
        for row in self._rows():
            found = self._found(row, list(towards))
            if wrong := [name for name, rises in found.items() if towards[name] != rises]:
                reason = f"the objective pushes '{wrong[0]}' against this limit"
                self._refuse(row.parts, Obstacle(reason, None))
        return towards

    def _rows(self) -> Iterator[_Use]:
        root: tuple[Part, ...] = ("phases", self.index, "boundary")
        boundary = [((*root, number), one) for number, one in enumerate(self.phase.boundary)]
        linkages = [(("linkages", number), one) for number, one in enumerate(self.problem.linkages)]
        for place, one in (*boundary, *linkages):
            both = one.lower is not None and one.upper is not None
            yield _Use(
                (*place, "expression"), one.expression.tree, None if both else one.lower is None
            )

    def _found(self, use: _Use, integrals: list[str]) -> dict[str, bool]:
        """The integrals in an expression, and whether it rises with each of them."""
        phase = self.phase if use.parts[0] == "phases" else None
        bare = phase is not None or len(self.problem.phases) == 1
        names = {f"{self.phase.name}.{name}": name for name in integrals}
        names |= {name: name for name in integrals} if bare else {}
        objective = phase is None and use.parts[0] == "objective"
        found: dict[str, bool] = {}

        def is_part(tree: Name | Call) -> bool:
            if isinstance(tree, Name):
                return tree.name in names
            return objective and tree.function in NONSMOOTH and not self._is_constant(tree)

        def note(tree: Name | Call, rises: bool) -> Tree:
            if isinstance(tree, Call):
                raise Obstacle("only what is integrated along a phase has one", tree.column)
            if use.rises is None or found.setdefault(names[tree.name], rises) != rises:
                raise Obstacle(f"both more and less of '{tree.name}' matter here", tree.column)
            return tree

        by = Replacement(is_part, note, lambda name: self.signs.at_ends(phase, name))
        try:
            replaced(use.tree, by, rises=use.rises is not False)
        except Obstacle as obstacle:
            self._refuse(use.parts, obstacle)
            return {}
        return found

    def _is_constant(self, tree: Tree) -> bool:
        """Whether only parameters are in a tree, also with their phase in front."""
        parameters = self.phase.system.parameters
        return all(name.name.rpartition(".")[2] in parameters for name in names_in(tree))

    # What the integrals do with their absolute values.

    def _sign(self, name: str) -> Sign:
        return self.signs.along(self.phase, name)

    def _is_part(self, tree: Name | Call) -> bool:
        if isinstance(tree, Name):
            return tree.name in self.rough
        return tree.function in NONSMOOTH and not self._is_constant(tree)

    def _replace(self, tree: Name | Call, rises: bool) -> Tree:
        if isinstance(tree, Name):
            return self._inline(tree, rises)
        if rises == (tree.function == "min"):
            way = "rises" if rises else "falls"
            raise Obstacle(f"the objective {way} with this {tree.function}", tree.column)
        if tree.function == "abs" and self.by.concerns(tree.arguments[0]):
            raise Obstacle("its argument holds another one", tree.column)
        arguments = tuple(replaced(one, self.by, rises=rises) for one in tree.arguments)
        return self._slack(Call(tree.function, arguments, tree.column))

    def _inline(self, name: Name, rises: bool) -> Tree:
        """An intermediate that holds an absolute value, in the integral itself."""
        self.inlined += 1
        if self.inlined > _MOST_INLINED:
            raise Obstacle(f"over {_MOST_INLINED} uses of intermediates that hold one", name.column)
        try:
            return replaced(self.define[name.name], self.by, rises=rises)
        except Obstacle as obstacle:
            raise Obstacle(f"in '{name.name}', {obstacle.message}", name.column) from None

    def _slack(self, value: Call) -> Name:
        """The slack for a value, the same for the same value, with its rows."""
        key = without_columns(value)
        if key not in self.slacks:
            slack = self.slacks[key] = Name(f"slack({len(self.slacks) + 1})")
            self.result.values[slack.name] = value
            self.result.rows |= _rows(slack, value)
        return self.slacks[key]


def _rows(slack: Name, value: Call) -> dict[str, Tree]:
    """The slack is not on the wrong side of any argument."""
    arguments = value.arguments
    if value.function == "abs":
        arguments = (*arguments, Call("neg", arguments))
    sides = [(one, slack) if value.function == "min" else (slack, one) for one in arguments]
    return {
        f"{slack.name} against argument {place}": Call("-", side)
        for place, side in enumerate(sides, 1)
    }
