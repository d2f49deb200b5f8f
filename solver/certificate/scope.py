"""Numbers that boundary constraints and objectives are over."""

from collections.abc import Mapping
from typing import NamedTuple


class Quadrature(NamedTuple):
    """An integral over the published curves, and a bound on the quadrature's own error."""

    value: float
    error: float


class Numbers(NamedTuple):
    """Of one phase, by name.

    Attributes
    ----------
    statics, parameters
        What does not change.
    integrals
        Over the phase.
    ends
        ``initial.NAME`` and ``final.NAME``.
    duration
        In seconds.
    """

    statics: Mapping[str, float]
    parameters: Mapping[str, float]
    integrals: Mapping[str, Quadrature]
    ends: Mapping[str, float]
    duration: float

    def scope(self) -> dict[str, float]:
        """All of them together."""
        integrals = {name: found.value for name, found in self.integrals.items()}
        ends = {**self.ends, "duration": self.duration}
        return {**self.statics, **self.parameters, **integrals, **ends}
