"""The bounds of a problem that are plain numbers: those can be drawn."""

from collections.abc import Mapping
from typing import Any

Limits = Mapping[str, tuple[float, ...]]
"""Name of a state or control -> its numeric limits, one or two."""


def limits_of(problem: Mapping[str, Any] | None, phase: str) -> Limits:
    """The numeric bounds of one phase of a problem; none without a problem."""
    phases = problem.get("phases", []) if problem else []
    found = [p for p in phases if p.get("name", "phase") == phase]
    bounds = found[0].get("bounds", {}) if found else {}
    return {name: _levels(bound) for name, bound in bounds.items()}


def _levels(bound: Any) -> tuple[float, ...]:
    sides = bound if isinstance(bound, list) else [bound]
    return tuple(float(side) for side in sides if _is_number(side))


def _is_number(side: Any) -> bool:
    return isinstance(side, int | float) and not isinstance(side, bool)
