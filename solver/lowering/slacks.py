"""Slacks in place of absolute values, where a problem asks for them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from schemas.epigraph import epigraph
from schemas.errors import InvalidModel
from schemas.expressions import Tree
from schemas.problem import Problem


@dataclass(frozen=True, slots=True)
class Slacks:
    """Names to add to a phase as controls are, with rows and integrands over them.

    Attributes
    ----------
    names
        Of the slacks; no user can write them.
    rows
        Label -> tree that has to be >= 0 along the phase.
    integrals
        Every integral of the phase -> its integrand, with slacks in place.
    values
        Slack -> tree of its value at the optimum, over names of the form and earlier slacks: from
        where to start it.
    """

    names: tuple[str, ...] = ()
    rows: Mapping[str, Tree] = field(default_factory=dict)
    integrals: Mapping[str, Tree] = field(default_factory=dict)
    values: Mapping[str, Tree] = field(default_factory=dict)


def slacks(problem: Problem, index: int) -> Slacks:
    """The slacks of a phase; none where the problem does not ask for them.

    What does not enter the objective keeps its absolute values: nothing would press slacks there.

    Raises
    ------
    InvalidModel
        Where the objective would not press them; reading a problem refuses that already.
    """
    phase = problem.phases[index]
    integrals = {name: one.tree for name, one in phase.integrals.items()}
    if problem.nonsmooth is None or problem.nonsmooth.abs != "slack":
        return Slacks(integrals=integrals)
    found = epigraph(problem, index)
    if found.issues:
        raise InvalidModel(found.issues)
    return Slacks(tuple(found.values), found.rows, integrals | found.integrals, found.values)
