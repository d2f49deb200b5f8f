"""How named integrals enter the program: added up where they arise, or lifted.

An integral that enters the objective with a constant factor, and nothing else, is added up
segment by segment. Any other becomes a decision variable with a row that ties it to its sum, so
that the Hessian stays sparse.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from solver.expressions import SX, scalars
from solver.model import Phase
from solver.model.drift import drift_names
from solver.model.symbolic import PhaseFunctions
from solver.nlp.variables import Array
from solver.trajectory import Trajectory

_SAMPLES = 201


@dataclass(frozen=True, slots=True)
class IntegralUse:
    """Factors in the objective (0 where lifted) and positions of those lifted, over all phases."""

    factors: Array
    lifted: tuple[int, ...]

    def weights(self, counts: Sequence[int]) -> list[Array]:
        """What each phase's integrals add to the sums: one array (sums, integrals) per phase."""
        total = np.zeros((1 + len(self.lifted), len(self.factors)))
        total[0] = self.factors
        for row, position in enumerate(self.lifted, start=1):
            total[row, position] = 1.0
        return np.split(total, np.cumsum(counts)[:-1], axis=1)


@dataclass(frozen=True, slots=True)
class Sorted:
    """Which integrals are lifted, and the others' factors as a function of the constants."""

    lifted: tuple[int, ...]
    factors: ca.Function

    @property
    def direct(self) -> tuple[int, ...]:
        """Positions of those that are added up in place."""
        return tuple(i for i in range(self.factors.numel_out(0)) if i not in self.lifted)

    def use(self, constants: Sequence[float]) -> IntegralUse:
        """With the constants' values."""
        return IntegralUse(self.factors(ca.DM(constants)).full().ravel(), self.lifted)


def classify(objective: SX, constraints: SX, integrals: SX, constants: SX) -> Sorted:
    """Which integrals can be added up in place, and with what factor."""
    slopes = ca.densify(ca.gradient(objective, integrals))
    constrained = ca.which_depends(constraints, integrals, 1, False)
    known = {one.element_hash() for one in scalars(constants)}
    lifted = tuple(
        i
        for i in range(integrals.numel())
        if constrained[i] or any(one.element_hash() not in known for one in ca.symvar(slopes[i]))
    )
    factors = [SX(0) if i in lifted else slopes[i] for i in range(integrals.numel())]
    outputs = ca.vertcat(SX(0, 1), *factors)
    return Sorted(lifted, ca.Function("factors", [constants], [outputs]))


def guessed_integrals(
    phase: Phase, functions: PhaseFunctions, guess: Trajectory, numbers: Sequence[float]
) -> Array:
    """The integrals (integrals,) along a guess, by the trapezoid rule.

    ``numbers`` are those of the statics, then the phase's constants. 1 where that gives zero or no
    number: roots and quotients of integrals need a slope there.
    """
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    times = guess.start + (guess.end - guess.start) * fractions
    wanted = functions.integrands.size1_in(2)  # none where unknowns are eliminated
    algebraic = (*phase.algebraic, *drift_names(phase.form))[:wanted]
    series = [
        guess.sample(names, fractions)
        for names in (phase.states, phase.controls, algebraic, phase.natives)
    ]
    constants = np.repeat(np.array(numbers, dtype=float)[:, None], _SAMPLES, axis=1)
    integrands = functions.integrands.map(_SAMPLES)(*series, times[None, :], constants).full()
    with np.errstate(all="ignore"):  # poles on both sides of nothing
        totals = np.trapezoid(integrands, times, axis=1)
    return np.where(np.isfinite(totals) & (totals != 0), totals, 1.0)
