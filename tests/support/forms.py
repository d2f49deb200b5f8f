"""Forms written by hand, for tests of what reads them."""

from collections.abc import Mapping, Sequence
from typing import Any

from schemas.expressions import Tree, parse
from solver.lowering.form import Form, Unknowns


def trees(texts: Mapping[str, str]) -> dict[str, Tree]:
    """Expressions by name."""
    return {name: parse(text) for name, text in texts.items()}


def unknowns(names: Sequence[str], *residuals: str) -> Unknowns:
    """A group of unknowns and what vanishes with them."""
    labels = tuple(f"residual {index}" for index in range(len(residuals)))
    return Unknowns(tuple(names), tuple(parse(text) for text in residuals), labels)


def form(derivatives: Mapping[str, str], controls: Sequence[str] = (), **others: Any) -> Form:
    """A form of these derivatives; definitions and flows are texts, too."""
    texts = {key: trees(others.pop(key, {})) for key in ("definitions", "flow")}
    states = tuple(derivatives) or tuple(texts["flow"])
    return Form(
        constants=others.pop("constants", {}),
        states=states,
        controls=tuple(controls),
        definitions=texts["definitions"],
        derivatives=trees(derivatives),
        flow=texts["flow"],
        **others,
    )
