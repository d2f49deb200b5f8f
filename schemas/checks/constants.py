"""Constants of a phase, evaluated once, each failure reported once and at its own place."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from schemas.errors import Issue
from schemas.expressions import Expression, ExpressionError, names_in
from schemas.phases import Phase
from schemas.pointers import Part, pointer
from schemas.resolve import scalar
from schemas.values import Bound, Scalar

Interval = tuple[float, float]


@dataclass(slots=True)
class Constants:
    """Evaluates constants over a phase's parameters; collects the issues on the way.

    What rests on a parameter that cannot be evaluated counts as unknown, without an issue of
    its own. ``chosen`` are the names of which the solver chooses the values.
    """

    known: dict[str, float] = field(default_factory=dict)
    broken: set[str] = field(default_factory=set)
    chosen: frozenset[str] = frozenset()
    issues: list[Issue] = field(default_factory=list)

    @classmethod
    def of(cls, phase: Phase, root: tuple[Part, ...], statics: Iterable[str] = ()) -> "Constants":
        """The phase's parameters, in order."""
        names = [*statics, *phase.system.state_names, *phase.system.control_names]
        self = cls(chosen=frozenset(names))
        for name, raw in phase.system.parameters.items():
            value = self.value(raw, (*root, "system", "parameters", name))
            if value is None:
                self.broken.add(name)
            else:
                self.known[name] = value
        return self

    def value(self, raw: Scalar, parts: tuple[Part, ...]) -> float | None:
        """The number, or None with an issue."""
        if isinstance(raw.source, Expression) and any(
            name.name in self.broken for name in names_in(raw.source.tree)
        ):
            return None
        try:
            return scalar(raw, self.known)
        except ExpressionError as error:
            hint = self._chosen(raw, parts) or error.hint
            self.issues.append(Issue(pointer(*parts), error.message, hint, error.column))
            return None

    def _chosen(self, raw: Scalar, parts: tuple[Part, ...]) -> str:
        """Where an expression may stand that rests on what the solver chooses."""
        tree = raw.source.tree if isinstance(raw.source, Expression) else None
        name = next((n.name for n in names_in(tree) if n.name in self.chosen), "") if tree else ""
        if not name:
            return ""
        if "parameters" in parts:
            return f"the solver chooses '{name}': move this to 'define'"
        return f"the solver chooses '{name}': write a constraint, in 'path' or 'boundary'"

    def interval(self, bound: Bound, parts: tuple[Part, ...]) -> Interval | None:
        """Both limits, infinite where open; None with an issue where they make no interval."""
        if bound.fixed and bound.lower is not None:
            value = self.value(bound.lower, parts)
            return None if value is None else (value, value)
        lower = -math.inf if bound.lower is None else self.value(bound.lower, (*parts, 0))
        upper = math.inf if bound.upper is None else self.value(bound.upper, (*parts, 1))
        return self.ordered(lower, upper, parts)

    def ordered(
        self, lower: float | None, upper: float | None, parts: tuple[Part, ...]
    ) -> Interval | None:
        """The pair, or None where a limit is unknown or the lower one is above the upper one."""
        if lower is None or upper is None:
            return None
        if lower > upper:
            message = f"the lower limit {lower:g} is above the upper limit {upper:g}"
            self.issues.append(Issue(pointer(*parts), message, "swap them"))
            return None
        return lower, upper

    def drain(self) -> Iterator[Issue]:
        """The issues since the last call."""
        found, self.issues = self.issues, []
        yield from found
