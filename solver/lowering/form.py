"""The form that every system is lowered to."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from schemas.expressions import Tree
from solver.mechanics.principle import Principle


@dataclass(frozen=True, slots=True)
class Unknowns:
    """Names that vary along a phase and are found from as many residuals, which are zero.

    ``residuals`` may use states, controls, definitions that need no later unknowns, and the
    ``names`` themselves. ``labels`` say what to call each row.
    """

    names: tuple[str, ...]
    residuals: tuple[Tree, ...]
    labels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Holonomic:
    """What a contact or a closed loop keeps at zero: definitions of a form, by name.

    ``place`` over coordinates alone, None where there is no such function (rolling on curved
    ground); ``rate`` its rate, linear in the velocities. ``anchored`` places are kept at zero,
    others where the phase starts.
    """

    label: str
    place: str | None
    rate: str
    anchored: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """The definitions behind it."""
        return (self.rate,) if self.place is None else (self.place, self.rate)


@dataclass(frozen=True, slots=True)
class Form:
    """A phase's motion, all trees over names of this form, ``t`` and the problem's statics.

    Attributes
    ----------
    constants
        The system's parameters as numbers.
    states, controls
        Names; velocities are ``d(q)``. A control whose derivatives are used is a state, followed
        by its derivatives but the highest, which is the control.
    unknowns
        Groups of algebraic names, each to be solved for after those before it: accelerations of
        implicit systems and their derivatives.
    definitions
        Intermediates in an order in which each needs only those before it (or unknowns): the
        user's own, derivatives such as ``d(x)`` that are no states, and pieces of large ones
        under names with a ``#``. Those alone that something of the phase uses.
    derivatives
        The time derivative of every state but those of a closed form or a native form.
    flow
        Of a closed form: each state over ``initial.NAME``, ``initial.t``, ``t`` and definitions
        over these; else empty.
    natives, residuals
        Of a native form only: names that the method itself supplies along the phase, and what
        it has to make zero, label -> tree.
    publish
        Group of a result -> the series that users see in it.
    holonomic
        What contacts and loops hold. The unknowns' rows keep its acceleration at zero; methods
        keep it from drifting (``solver.model.drift``).
    balance
        Under time steps through contact, label -> residual over accelerations ``dd(q)``, which are
        then no unknowns: the method makes them of velocities.
    solid
        Gaps between bodies, which must not pass through each other within a step.
    principle
        The same under discrete-gradient steps: what the balance of momentum is made of.
    """

    constants: Mapping[str, float]
    states: tuple[str, ...]
    controls: tuple[str, ...]
    definitions: Mapping[str, Tree]
    derivatives: Mapping[str, Tree]
    unknowns: tuple[Unknowns, ...] = ()
    flow: Mapping[str, Tree] = field(default_factory=dict)
    natives: tuple[str, ...] = ()
    residuals: Mapping[str, Tree] = field(default_factory=dict)
    publish: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    holonomic: tuple[Holonomic, ...] = ()
    balance: Mapping[str, Tree] = field(default_factory=dict)
    solid: tuple[str, ...] = ()
    principle: Principle | None = None

    @property
    def algebraic(self) -> tuple[str, ...]:
        """All unknowns, in the order in which they are solved for."""
        return tuple(name for group in self.unknowns for name in group.names)
