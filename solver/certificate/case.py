"""What is judged: a problem's text and the published curves, ready to be evaluated."""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from schemas import resolve
from schemas.expressions import Name, Tree
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.results import PhaseResult
from schemas.stepped import stepped_by
from schemas.urdf import Urdf
from solver.certificate.bodies import Bodies, Evaluate
from solver.certificate.clock import ENDLESS, Clock
from solver.certificate.scope import Numbers, Quadrature
from solver.certificate.stepped import ContactCase
from solver.lowering import lower
from solver.lowering.form import Form
from solver.lowering.used import used_integrals
from solver.numeric import (
    Along,
    Array,
    MalformedCurves,
    PhaseCurves,
    Samples,
    along,
    departure,
    dynamics,
    integrate,
)

COARSE_TOLERANCE = 1e-3
"""Judges dynamics and objective where the mesh was not refined and nothing was asked for."""

SAMPLES = 25
"""Points a segment, both ends included, at which bounds and path constraints are sampled."""


@dataclass(frozen=True)
class PhaseCase:
    """One phase's text and its curves. Not slotted: what several checks need is cached.

    ``statics`` are numbers that every expression may use; ``judged`` names the integrals that
    something depends on: no other is computed.
    """

    spec: Phase
    form: Form
    curves: PhaseCurves
    statics: Mapping[str, float]
    judged: tuple[str, ...]
    clock: Clock = ENDLESS

    @property
    def name(self) -> str:
        """The phase's name."""
        return self.spec.name

    @functools.cached_property
    def given(self) -> dict[str, float]:
        """Numbers beside the form's own: the statics, and the start of a closed form."""
        return {**self.statics, **departure(self.form, self.curves)}

    @functools.cached_property
    def parameters(self) -> dict[str, float]:
        """The system's parameters, which limits may use."""
        return resolve.parameters(self.spec.system)

    @functools.cached_property
    def bodies(self) -> Bodies | None:
        """The bodies of a mechanism, read anew: nothing of the solver's mechanics is in them."""
        system = self.spec.system
        if isinstance(system, Mechanism | Urdf):
            return Bodies.of(self.form, system, self.statics)
        return None

    @functools.cached_property
    def dynamics(self) -> Along | Bodies:
        """The derivatives of the states; not for closed forms."""
        return self.bodies or dynamics(self.form, self.given)

    def expressions(self, trees: Sequence[Tree]) -> Evaluate:
        """Expressions along the phase; what a mechanism names is computed from its bodies."""

        def of_form(trees: Sequence[Tree]) -> Evaluate:
            return along(self.form, trees, self.given)

        return self.bodies.expressions(trees, of_form) if self.bodies else of_form(trees)

    @functools.cached_property
    def samples(self) -> Samples:
        """The curves between the nodes, with both limits at every break."""
        return self.curves.grid(np.linspace(-1.0, 1.0, SAMPLES))

    @functools.cached_property
    def scale(self) -> Array:
        """One plus the largest size of each state along the phase, (states,)."""
        return np.asarray(1.0 + np.abs(self.samples.x).max(axis=1))

    def sampled(self, trees: Sequence[Tree]) -> Array:
        """Expressions at the samples, (trees, samples)."""
        at = self.samples
        return self.expressions(trees)(at.t, at.x, at.u)

    @functools.cached_property
    def integrals(self) -> dict[str, Quadrature]:
        """The named integrals that matter, over the published curves."""
        trees = [self.spec.integrals[name].tree for name in self.judged]
        integrand = self.expressions(trees)

        def timed(at: Samples) -> Array:
            self.clock.look()
            return integrand(at.t, at.x, at.u)

        found = integrate(self.curves, timed)
        pairs = zip(found.value.tolist(), found.error.tolist(), strict=True)
        return {name: Quadrature(*pair) for name, pair in zip(self.judged, pairs, strict=True)}

    @functools.cached_property
    def ends(self) -> dict[str, float]:
        """``initial.NAME`` and ``final.NAME`` of time and of every name of the form."""
        form, at = self.form, self.samples
        names = ["t", *form.states, *form.controls, *form.definitions, *form.algebraic]
        x, u = at.x[:, [0, -1]], at.u[:, [0, -1]]
        values = self.expressions([Name(name) for name in names])(at.t[[0, -1]], x, u)
        return {
            f"{side}.{name}": float(value)
            for side, column in zip(("initial", "final"), values.T, strict=True)
            for name, value in zip(names, column, strict=True)
        }

    @property
    def duration(self) -> float:
        """From the first to the last time, in seconds."""
        return float(self.curves.breaks[-1] - self.curves.breaks[0])

    @functools.cached_property
    def scope(self) -> dict[str, float]:
        """Every number that boundary constraints and objectives may use."""
        own = (self.statics, self.parameters, self.integrals, self.ends, self.duration)
        return Numbers(*own).scope()


AnyPhase = PhaseCase | ContactCase


@dataclass(frozen=True)
class Case:
    """All phases, the published objective, and the tolerances to judge by."""

    problem: Problem
    phases: tuple[AnyPhase, ...]
    statics: Mapping[str, float]
    objective: float | None
    tolerance: float
    constraint_tolerance: float

    @classmethod
    def open(
        cls,
        problem: Problem,
        results: Sequence[PhaseResult],
        objective: float | None,
        statics: Mapping[str, float | None],
        clock: Clock = ENDLESS,
    ) -> Self:
        """Read the curves of every phase.

        Raises
        ------
        MalformedCurves
            If a phase has no result, or one that cannot be read.
        """
        by_name = {result.name: result for result in results}
        values = {name: _number(statics.get(name)) for name in problem.static}
        phases: list[AnyPhase] = []
        for index, (spec, form) in enumerate(zip(problem.phases, lower(problem), strict=True)):
            if spec.name not in by_name:
                raise MalformedCurves(f"phase {spec.name} has no result")
            if stepped_by(problem, spec) is not None:
                found = by_name[spec.name]
                phases.append(ContactCase.of(problem, index, found, values, clock))
                continue
            curves = PhaseCurves.read(form, by_name[spec.name])
            used = used_integrals(problem, spec)
            phases.append(PhaseCase(spec, form, curves, values, used, clock))
        settings = problem.certificate
        tolerances = certificate_tolerance(problem), settings.constraint_tolerance
        return cls(problem, tuple(phases), values, objective, *tolerances)

    @property
    def curved(self) -> list[PhaseCase]:
        """The phases whose curves have to obey the dynamics all along."""
        return [phase for phase in self.phases if isinstance(phase, PhaseCase)]

    @property
    def stepped(self) -> list[ContactCase]:
        """The phases of contact-implicit steps."""
        return [phase for phase in self.phases if isinstance(phase, ContactCase)]

    @functools.cached_property
    def scope(self) -> dict[str, float]:
        """Every phase's names under its prefix; the only phase's bare as well; the statics."""
        scope = {
            f"{phase.name}.{name}": value
            for phase in self.phases
            for name, value in phase.scope.items()
        }
        only = self.phases[0].scope if len(self.phases) == 1 else {}
        return {**scope, **only, **self.statics}


def certificate_tolerance(problem: Problem) -> float:
    """What judges dynamics and objective, unless the problem says it itself."""
    if problem.certificate.tolerance is not None:
        return problem.certificate.tolerance
    return min(1.0, 10 * problem.refinement.tolerance) if problem.refinement else COARSE_TOLERANCE


def _number(value: float | None) -> float:
    return math.nan if value is None else value
