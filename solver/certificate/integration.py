"""The independent integrator: scipy's DOP853 with tolerances that mean something."""

from collections.abc import Callable

import numpy as np
import scipy  # loads scipy.integrate, which takes long, when it is first asked for

from solver.numeric import Array

TIGHTEST = 2.3e-14
"""The smallest relative tolerance that scipy accepts."""

EVALUATIONS = 50_000
"""Calls of the dynamics after which an integration is given up: stiff, or blowing up."""


class Unfinished(ArithmeticError):
    """The integrator did not get to the end.

    ``at`` is how far it came and ``rates`` (n,) the last that it saw, to find the culprit by.
    """

    def __init__(self, reason: str, at: float, rates: Array) -> None:
        super().__init__(reason)
        self.at = at
        self.rates = rates


class Integrator:
    """Solves y' = rates(t, y) from place to place, within a budget of evaluations.

    Parameters
    ----------
    tolerance
        Relative, of each step; the absolute one is a hundredth of it. scipy's default of 1e-3
        would judge a mesh by an integrator that is worse than the mesh.
    evaluations
        Calls of the rates in all.
    """

    def __init__(self, tolerance: float, evaluations: int = EVALUATIONS) -> None:
        self.tolerance = max(tolerance, TIGHTEST)
        self.left = evaluations

    def advance(
        self, rates: Callable[[float, Array], Array], start: float, y: Array, end: float
    ) -> Array:
        """The state (n,) at ``end`` from that at ``start``; one step where that is accurate.

        Raises
        ------
        Unfinished
            If the state or its rates have no value at the start, the steps vanish, or the budget
            is spent.
        """
        if not np.all(np.isfinite(y)):
            raise Unfinished("the state is not finite", start, y)
        last = y

        def watched(t: float, y: Array) -> Array:
            nonlocal last
            self.left -= 1
            last = rates(t, y)
            if self.left < 0:
                raise Unfinished("the integrator takes too many steps", t, last)
            return last

        with np.errstate(all="ignore"):
            solver = scipy.integrate.DOP853(
                watched,
                start,
                y,
                end,
                rtol=self.tolerance,
                atol=self.tolerance / 100,
                first_step=end - start,
            )
            if not np.all(np.isfinite(solver.f)):
                raise Unfinished("the dynamics have no finite value", start, solver.f)
            while solver.status == "running":
                solver.step()
        if solver.status == "failed":
            raise Unfinished("the integrator's steps vanish", float(solver.t), last)
        return np.asarray(solver.y)
