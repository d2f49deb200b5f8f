"""A scaled program with its start and limits: what a backend is given."""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from solver.nlp.assembly import Nlp, assemble
from solver.nlp.program import Program
from solver.nlp.redundancy import Redundancy
from solver.nlp.scaling import Scaling

Array = NDArray[np.float64]
Indices = NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class NlpTask:
    """Functions, start and limits, all scaled: z (n,), rows (m,).

    ``nodes`` (n,) puts the variables in order of time, as ``Program.nodes`` does; None where the
    order is not known.

    ``row_multipliers`` (m,) and ``bound_multipliers`` (n,) belong to the start where it is the
    optimum of a program much like this one, in the convention of ``Outcome``: a warm start then
    begins from them, too. None where nothing is known of them.
    """

    nlp: Nlp
    start: Array
    lower: Array
    upper: Array
    row_lower: Array
    row_upper: Array
    nodes: Indices | None = None
    row_multipliers: Array | None = None
    bound_multipliers: Array | None = None

    @classmethod
    def of(cls, program: Program, scaling: Scaling) -> Self:
        """Assemble the program, and scale its guess and its limits."""
        variables = program.variables
        return cls(
            nlp=assemble(program, scaling),
            start=variables.gather("guess") / scaling.columns,
            lower=variables.gather("lower") / scaling.columns,
            upper=variables.gather("upper") / scaling.columns,
            row_lower=program.row_vector("lower", 0.0) / scaling.rows,
            row_upper=program.row_vector("upper", 0.0) / scaling.rows,
            nodes=program.nodes(),
        )

    def without(self, redundancy: Redundancy) -> Self:
        """The same, with the rows and fixed values opened that others imply."""
        rows = np.concatenate([redundancy.rows, redundancy.decided])
        return replace(
            self,
            lower=_opened(self.lower, redundancy.fixed, -np.inf),
            upper=_opened(self.upper, redundancy.fixed, np.inf),
            row_lower=_opened(self.row_lower, rows, -np.inf),
            row_upper=_opened(self.row_upper, rows, np.inf),
        )

    def violation(self, rows: Array, z: Array | None = None) -> float:
        """The largest violation of a scaled row; infinite where not a number.

        With ``z``, of the bounds too: for backends whose iterates may lie outside of them.
        """
        excess = np.maximum(self.row_lower - rows, rows - self.row_upper)
        worst = float(excess.max(initial=0.0))
        if z is not None:
            outside = np.maximum(self.lower - z, z - self.upper)
            worst = max(worst, float(outside.max(initial=0.0)))
        return worst if math.isfinite(worst) else math.inf


def _opened(limits: Array, places: Indices, value: float) -> Array:
    opened = limits.copy()
    opened[places] = value
    return opened
