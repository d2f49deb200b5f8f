"""Expressions of one phase, said of its parts."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from schemas import resolve
from schemas.expressions import Call, Expression, Name, Tree
from schemas.phases import Constraint, Phase
from schemas.problem import Objective, Problem
from schemas.values import Scalar


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


def renaming(problem: Problem, phase: Phase, parts: Sequence[str], *prefixes: str) -> Renaming:
    """What the names of one phase mean, written behind any of the prefixes."""
    return Renaming(prefixes, parts, phase.integrals, problem.static)


def renamings(problem: Problem, parts: Mapping[str, Sequence[str]]) -> list[Renaming]:
    """Those of the split phases (name -> parts), for expressions that see the whole problem."""
    alone = ("",) if len(problem.phases) == 1 else ()
    return [
        renaming(problem, phase, parts[phase.name], f"{phase.name}.", *alone)
        for phase in problem.phases
        if phase.name in parts
    ]


def renamed_objective(problem: Problem, parts: Mapping[str, Sequence[str]]) -> Objective | None:
    """The objective over the parts."""
    if problem.objective is None:
        return None
    minimize = problem.objective.minimize
    for one in renamings(problem, parts):
        minimize = one.expression(minimize)
    return problem.objective.model_copy(update={"minimize": minimize})


def renamed_linkages(problem: Problem, parts: Mapping[str, Sequence[str]]) -> list[Constraint]:
    """The linkages over the parts."""
    rows = []
    for row in problem.linkages:
        expression = row.expression
        for one in renamings(problem, parts):
            expression = one.expression(expression)
        rows.append(row.model_copy(update={"expression": expression}))
    return rows


def whole_rows(problem: Problem, phase: Phase, parts: Sequence[str]) -> list[Constraint]:
    """What holds for a split phase as a whole: its boundary constraints, and its duration."""
    rename, constants = renaming(problem, phase, parts, ""), resolve.parameters(phase.system)
    rows = [
        linkage(row.name, rename.expression(row.expression), resolve.interval(row, constants))
        for row in phase.boundary
    ]
    if phase.time.duration is not None:
        duration = rename.expression(Expression("duration", Name("duration")))
        limits = resolve.interval(phase.time.duration, constants)
        rows.append(linkage("duration", duration, limits))
    return rows


def equal(name: str, left: str, right: str) -> Constraint:
    """A linkage between two names."""
    tree = Call("-", (Name(left), Name(right)))
    return linkage(name, Expression(f"{left} - {right}", tree))


def linkage(
    name: str, expression: Expression, limits: tuple[float, float] = (0.0, 0.0)
) -> Constraint:
    """With limits as numbers: a linkage knows no phase's parameters."""
    lower, upper = (Scalar(limit) if math.isfinite(limit) else None for limit in limits)
    return Constraint.model_construct(name=name, expression=expression, lower=lower, upper=upper)
