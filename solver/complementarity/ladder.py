"""What a homotopy has yet to solve, and what it tries where a pass fails: all of it data.

A pass that fails goes back to the last good point. As long as there is none it begins softer and
with an adaptive barrier. Else it takes a smaller step, to the geometric mean of both relaxations;
then inequalities, of which pairs with both members at zero leave more; at last a regularised
system, since pairs of bodies at rest make rows depend on each other: that crawls where it does not
help. Each only so many times, and the cheapest first.
"""

from dataclasses import dataclass, replace
from math import sqrt
from typing import Self

from schemas.methods import Relaxation
from solver.backends import Strategy

INEQUALITY = "inequality"

MONOTONE = Strategy("default", exact=True)
STEADY = Strategy("steady", exact=True, steady=True)
ADAPTIVE = Strategy("adaptive barrier", adaptive=True, exact=True)

_SMALLER_STEPS = 2
_CLOSE = 1.5  # a step by less is no step
_SOFTER = 10.0
_RESUMED = 1e-3  # from the solution of another mesh
_FURTHER = (0.1, 0.01)  # of the end of the schedule, where it leaves open which member is zero


@dataclass(frozen=True, slots=True)
class Ladder:
    """The passes ahead.

    Attributes
    ----------
    levels
        Relaxations to reach, falling; the first one is next.
    form
        How pairs are relaxed: the one asked for, or ``inequality``.
    strategies
        The one in use, then those to be tried as long as nothing was ``reached``.
    reached
        The relaxation of the last good pass.
    tries
        How often a step was made smaller.
    steadies, steady, changed
        Whether systems can be regularised, whether they are now, and whether that was changed for
        this pass.
    """

    levels: tuple[float, ...]
    form: str
    strategies: tuple[Strategy, ...] = (MONOTONE, ADAPTIVE)
    reached: float | None = None
    tries: int = 0
    steadies: bool = False
    steady: bool = False
    changed: bool = False

    @classmethod
    def of(
        cls,
        relaxation: Relaxation,
        strategies: tuple[Strategy, ...],
        *,
        warm: bool,
        steadies: bool = False,
    ) -> Self:
        """The schedule; its small end where the start solves the problem on another mesh."""
        levels = tuple(relaxation.schedule)
        if warm:
            levels = tuple(level for level in levels if level <= _RESUMED) or levels[-1:]
        return cls(levels, relaxation.form or "equality", strategies, steadies=steadies)

    @property
    def strategy(self) -> Strategy:
        """How to solve the next pass."""
        return (
            replace(self.strategies[0], steady=self.steady) if self.steady else self.strategies[0]
        )

    def on(self) -> "Ladder":
        """After a good pass."""
        return replace(
            self,
            levels=self.levels[1:],
            reached=self.levels[0],
            strategies=self.strategies[:1],
            changed=False,
        )

    def further(self) -> Self:
        """Below the end of the schedule."""
        reached = self.reached or 0.0
        return replace(self, levels=tuple(share * reached for share in _FURTHER), tries=0)

    def back(self) -> "Ladder | None":
        """After a pass that failed; None where nothing is left to try."""
        if len(self.strategies) > 1:
            levels = (self.levels[0] * _SOFTER, *self.levels)
            return replace(self, levels=levels, strategies=self.strategies[1:], tries=1)
        if (between := self._between()) is not None:
            levels = (between, *self.levels)
            return replace(self, levels=levels, tries=self.tries + 1, changed=False)
        if self.form not in (INEQUALITY, "summed"):
            return replace(self, form=INEQUALITY, tries=0, changed=False)
        if self.steadies and self.reached is not None and not self.changed:
            return replace(self, steady=not self.steady, changed=True)
        return None

    def _between(self) -> float | None:
        """A relaxation to go through on the way to the next one."""
        if self.reached is None:
            return None if self.tries else self.levels[0] * _SOFTER
        if self.tries >= _SMALLER_STEPS or self.reached < _CLOSE * self.levels[0]:
            return None
        return sqrt(self.reached * self.levels[0])
