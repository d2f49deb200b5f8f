"""The forms in which ``a b = 0`` is relaxed: the one table, and the rows and costs they make.

``a`` and ``b`` are members of a pair over their sizes, both at least zero; ``eps`` is the
relaxation, a variable of its own that is held at a value, so that a program is built once and a
pass of the homotopy changes limits alone. At ``eps = 0`` all forms ask for the same.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from types import MappingProxyType
from typing import Literal

from schemas.expressions import Call, Name, Number, Tree
from solver.complementarity.pair import Pair

RELAXATION = "#relaxation"
"""The static that holds eps."""

SUMMED_LABEL = "complementarity"
"""The label of the row that a summed relaxation has for all pairs of a step."""

Limits = tuple[float, float]
LabelledRow = tuple[str, Tree, Limits]


@dataclass(frozen=True, slots=True)
class Form:
    """One form of relaxation.

    Attributes
    ----------
    row
        (a, b, eps) -> what is compared with zero; where its rows are sums, their term.
    limits
        Of the row.
    rows
        Whether there is a row for each pair, or one for each step.
    priced
        Whether the sum of the products over eps is added to the objective.
    limit
        Whether the row is smooth at eps = 0, too.
    """

    row: Callable[[Tree, Tree, Tree], Tree]
    limits: Limits
    rows: Literal["pair", "step"] = "pair"
    priced: bool = False
    limit: bool = True


def product(a: Tree, b: Tree, eps: Tree) -> Tree:
    """``a b - eps``."""
    return Call("-", (Call("*", (a, b)), eps))


def fischer_burmeister(a: Tree, b: Tree, eps: Tree) -> Tree:
    """``a + b - sqrt(a^2 + b^2 + 2 eps)``: zero where ``a b = eps`` (Kanzow, 1996)."""
    squares = (*(Call("^", (one, Number(2.0))) for one in (a, b)), Call("*", (Number(2.0), eps)))
    return Call("-", (Call("+", (a, b)), Call("sqrt", (Call("+", squares),))))


FORMS: Mapping[str, Form] = MappingProxyType(
    {
        "equality": Form(product, (0.0, 0.0)),
        "inequality": Form(product, (-inf, 0.0)),
        "summed": Form(product, (-inf, 0.0), rows="step"),
        # The rows are open: an exact penalty has none. They stand by for where it fails.
        "penalty": Form(product, (-inf, inf), priced=True),
        "fischer_burmeister": Form(fischer_burmeister, (0.0, 0.0), limit=False),
    }
)
"""Name in ``schemas.methods.Relaxation`` -> form. A new one is a function and a line here."""

AT_MOST: Limits = (-inf, 0.0)
"""The limits by which the row of any form says ``a b <= eps``."""


def relaxation_rows(form: str, pairs: Sequence[Pair]) -> list[LabelledRow]:
    """The path rows of a phase: label, tree over its names and ``RELAXATION``, limits."""
    one, eps = FORMS[form], Name(RELAXATION)
    if one.rows == "pair":
        return [(pair.label, one.row(*_members(pair), eps), one.limits) for pair in pairs]
    if not pairs:
        return []
    return [(SUMMED_LABEL, Call("-", (_products(pairs), eps)), one.limits)]


def relaxation_cost(form: str, pairs: Sequence[Pair]) -> Tree | None:
    """What the form adds to the objective, an integrand over a phase; None for nothing."""
    if not FORMS[form].priced or not pairs:
        return None
    return Call("/", (_products(pairs), Name(RELAXATION)))


def _products(pairs: Sequence[Pair]) -> Tree:
    products = tuple(Call("*", _members(pair)) for pair in pairs)
    return products[0] if len(products) == 1 else Call("+", products)


def _members(pair: Pair) -> tuple[Tree, Tree]:
    """Both over their sizes."""
    first, second = (
        Name(name) if size == 1 else Call("/", (Name(name), Number(size)))
        for name, size in zip((pair.first, pair.second), pair.sizes, strict=True)
    )
    return first, second
