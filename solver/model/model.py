"""The model that the engine works on: numbers and typed trees, nothing of pydantic."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from schemas.expressions import Tree


class Interval(NamedTuple):
    """Lower and upper limit; equal where the value is fixed, infinite where it is open."""

    lower: float
    upper: float

    @property
    def fixed(self) -> bool:
        """Whether the interval is one point."""
        return self.lower == self.upper


@dataclass(frozen=True, slots=True)
class Constraint:
    """``lower <= tree <= upper``, along a phase or over its ends."""

    name: str
    tree: Tree
    limits: Interval


@dataclass(frozen=True, slots=True)
class Phase:
    """One phase. ``bounds``, ``initial`` and ``final`` hold an interval for every variable."""

    name: str
    states: tuple[str, ...]
    controls: tuple[str, ...]
    parameters: Mapping[str, float]
    definitions: Mapping[str, Tree]
    derivatives: tuple[Tree, ...]
    integrals: Mapping[str, Tree]
    path: tuple[Constraint, ...]
    boundary: tuple[Constraint, ...]
    bounds: Mapping[str, Interval]
    initial: Mapping[str, Interval]
    final: Mapping[str, Interval]
    start: Interval
    end: Interval

    @property
    def variables(self) -> tuple[str, ...]:
        """States, then controls."""
        return self.states + self.controls


@dataclass(frozen=True, slots=True)
class Model:
    """The phases and what to minimize over them (None: any feasible motion)."""

    phases: tuple[Phase, ...]
    objective: Tree | None
