"""The model that the engine works on: numbers and typed trees, nothing of pydantic."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from schemas.expressions import Tree
from solver.lowering import Form


class Interval(NamedTuple):
    """Lower and upper limit; equal where the value is fixed, infinite where it is open."""

    lower: float
    upper: float

    @property
    def fixed(self) -> bool:
        """Whether the interval is one point."""
        return self.lower == self.upper

    @property
    def finite(self) -> bool:
        """Whether a side of it limits anything."""
        return self.lower > -float("inf") or self.upper < float("inf")

    def nearest(self, value: float) -> float:
        """The value, or the limit that it passes."""
        return min(max(value, self.lower), self.upper)


OPEN = Interval(-float("inf"), float("inf"))


@dataclass(frozen=True, slots=True)
class Constraint:
    """``lower <= tree <= upper``, along a phase or over ends. ``label`` is how reports call it."""

    label: str
    tree: Tree
    limits: Interval


@dataclass(frozen=True, slots=True)
class Static:
    """A number that the solver chooses."""

    name: str
    limits: Interval
    guess: float


@dataclass(frozen=True, slots=True)
class Phase:
    """One phase.

    Attributes
    ----------
    form
        The motion, as the phase's method takes it.
    algebraic
        Names found at each node on its own: unknown accelerations, slacks.
    natives
        Names that the method itself supplies along the phase.
    path, boundary
        Constraints along the phase and over its ends.
    held
        What the form itself asks for along the phase: the unknowns' rows first.
    bounds, initial, final
        An interval for every state and control of the form.
    start
        None where the phase starts when the one before it ends.
    settled
        Labels of path constraints that others decide -> at which fractions of the phase.
    chain
        The motion in first-order form whatever the method: what results publish and the mesh
        error judges.
    wraps
        Whether the last step comes before the first one: of periodic phases.
    """

    name: str
    form: Form
    algebraic: tuple[str, ...]
    natives: tuple[str, ...]
    integrals: Mapping[str, Tree]
    path: tuple[Constraint, ...]
    held: tuple[Constraint, ...]
    boundary: tuple[Constraint, ...]
    bounds: Mapping[str, Interval]
    initial: Mapping[str, Interval]
    final: Mapping[str, Interval]
    start: Interval | None
    end: Interval
    duration: Interval
    chain: Form
    settled: Mapping[str, frozenset[float]] = field(default_factory=dict)
    wraps: bool = False

    @property
    def states(self) -> tuple[str, ...]:
        """The form's states."""
        return self.form.states

    @property
    def controls(self) -> tuple[str, ...]:
        """The form's controls."""
        return self.form.controls

    @property
    def parameters(self) -> Mapping[str, float]:
        """The system's constants."""
        return self.form.constants


@dataclass(frozen=True, slots=True)
class Model:
    """Phases, what links them, and what to minimize over them (None: any feasible motion)."""

    phases: tuple[Phase, ...]
    objective: Tree | None
    statics: tuple[Static, ...] = ()
    linkages: tuple[Constraint, ...] = ()

    @property
    def has_slacks(self) -> bool:
        """Whether slacks stand in for absolute values, min or max."""
        return any(len(phase.algebraic) > len(phase.form.algebraic) for phase in self.phases)
