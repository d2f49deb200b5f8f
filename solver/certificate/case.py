"""What is judged: a problem's text and the published curves, ready to be evaluated."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from schemas import resolve
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.numeric import (
    Along,
    Array,
    Integral,
    MalformedCurves,
    PhaseCurves,
    Samples,
    along,
    dynamics,
    integrate,
)

COARSE_TOLERANCE = 1e-3
"""Judges dynamics and objective where the mesh was not refined and nothing was asked for."""

SAMPLES = 25
"""Points a segment, both ends included, at which bounds and path constraints are sampled."""


@dataclass(frozen=True)
class PhaseCase:
    """One phase's text and its curves. Not slotted: what several checks need is cached."""

    spec: Phase
    curves: PhaseCurves

    @property
    def name(self) -> str:
        """The phase's name."""
        return self.spec.name

    @functools.cached_property
    def constants(self) -> dict[str, float]:
        """The system's parameters."""
        return resolve.parameters(self.spec.system)

    @functools.cached_property
    def dynamics(self) -> Along:
        """The derivatives of the states."""
        return dynamics(self.spec.system)

    @functools.cached_property
    def samples(self) -> Samples:
        """The curves between the nodes, with both limits at every break."""
        return self.curves.grid(np.linspace(-1.0, 1.0, SAMPLES))

    @functools.cached_property
    def scale(self) -> Array:
        """One plus the largest size of each state along the phase, (states,)."""
        return np.asarray(1.0 + np.abs(self.samples.x).max(axis=1))

    @functools.cached_property
    def integrals(self) -> Integral:
        """The named integrals over the published curves."""
        trees = [expression.tree for expression in self.spec.integrals.values()]
        integrand = along(self.spec.system, trees)
        return integrate(self.curves, lambda at: integrand(at.t, at.x, at.u))

    @functools.cached_property
    def ends(self) -> dict[str, float]:
        """``initial.NAME`` and ``final.NAME`` of time, states and controls."""
        names = ["t", *self.spec.system.states, *self.spec.system.controls]
        points = np.vstack([self.samples.t, self.samples.x, self.samples.u])
        return {
            f"{side}.{name}": float(row[column])
            for side, column in (("initial", 0), ("final", -1))
            for name, row in zip(names, points, strict=True)
        }

    @functools.cached_property
    def scope(self) -> dict[str, float]:
        """Every number that boundary constraints and objectives may use."""
        integrals = zip(self.spec.integrals, self.integrals.value.tolist(), strict=True)
        duration = self.ends["final.t"] - self.ends["initial.t"]
        return {**self.constants, **dict(integrals), **self.ends, "duration": duration}


@dataclass(frozen=True, slots=True)
class Case:
    """All phases, the published objective, and the tolerances to judge by."""

    problem: Problem
    phases: tuple[PhaseCase, ...]
    objective: float | None
    tolerance: float
    constraint_tolerance: float

    @classmethod
    def open(
        cls, problem: Problem, results: Sequence[PhaseResult], objective: float | None
    ) -> Self:
        """Read the curves of every phase.

        Raises
        ------
        MalformedCurves
            If a phase has no result, or one that cannot be read.
        """
        by_name = {result.name: result for result in results}
        phases = []
        for spec in problem.phases:
            if spec.name not in by_name:
                raise MalformedCurves(f"phase {spec.name} has no result")
            phases.append(PhaseCase(spec, PhaseCurves.read(spec, by_name[spec.name])))
        settings = problem.certificate
        return cls(
            problem, tuple(phases), objective, _tolerance(problem), settings.constraint_tolerance
        )


def _tolerance(problem: Problem) -> float:
    if problem.certificate.tolerance is not None:
        return problem.certificate.tolerance
    return min(1.0, 10 * problem.refinement.tolerance) if problem.refinement else COARSE_TOLERANCE
