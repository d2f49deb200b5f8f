"""Forms put to numbers: unknowns solved, definitions in their order, along given curves."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from schemas.expressions import Tree, names_in
from schemas.reading import read_problem
from solver.lowering import Form, Unknowns, lower
from solver.numeric.tape import Scope, record

Values = Mapping[str, Any]


def problem(system: dict[str, Any], integrand: str, **phase: Any) -> Any:
    """A checked problem of one phase that minimizes one integral."""
    only = {"system": system, "time": {"final": 1}, "integrals": {"cost": integrand}, **phase}
    return read_problem({"phases": [only], "objective": {"minimize": "cost"}})


def form_of(system: dict[str, Any], integrand: str, **phase: Any) -> Form:
    return lower(problem(system, integrand, **phase))[0]


def value(tree: Tree, known: Values) -> np.ndarray:
    """A tree over named arrays of one shape, that of the first, and numbers."""
    used = {name.name: known[name.name] for name in names_in(tree)}
    shape = np.shape(next(iter(known.values())))
    return record([tree], Scope(list(used)))(list(used.values()), shape)[0]


def complete(form: Form, known: Values) -> dict[str, Any]:
    """States, controls and time, with unknowns and definitions added to them."""
    names = {**known, **form.constants}
    for group in form.unknowns:
        names |= _defined(form, names)
        names |= _solved(form, group, names)
    return names | _defined(form, names)


def _defined(form: Form, known: Values) -> dict[str, Any]:
    """The definitions that can be evaluated, in the order of the form."""
    names = dict(known)
    for name, tree in form.definitions.items():
        try:
            names[name] = value(tree, names)
        except KeyError:  # needs unknowns that are not solved for yet
            continue
    return names


def _solved(form: Form, group: Unknowns, known: Values) -> dict[str, np.ndarray]:
    """The unknowns of one group, linear in its residuals: by probing, then a linear solve."""
    count = len(group.names)
    zeros = np.zeros_like(known["t"])

    def rows(unknowns: np.ndarray) -> np.ndarray:
        names = dict(known) | {n: zeros + v for n, v in zip(group.names, unknowns, strict=True)}
        names = _defined(form, names)
        return np.stack([value(tree, names) for tree in group.residuals], axis=-1)

    rest = rows(np.zeros(count))
    matrix = np.stack([rows(unit) - rest for unit in np.eye(count)], axis=-1)
    solved = np.linalg.solve(matrix, -rest[..., None])[..., 0]
    return {name: solved[..., column] for column, name in enumerate(group.names)}
