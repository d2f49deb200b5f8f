"""What is judged of a phase of contact-implicit steps: its text, and what was published of it."""

import functools
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas import resolve
from schemas.errors import InvalidModel
from schemas.expressions import Name, Tree
from schemas.mechanisms import Mechanism
from schemas.phases import Phase
from schemas.problem import Problem
from schemas.results import PhaseResult
from schemas.stepped import stepped_by
from schemas.urdf import Urdf
from solver.certificate.clock import Clock
from solver.certificate.complementary import complementary
from solver.certificate.energies import Energies, scale, step_energies
from solver.certificate.played import FINER, SECONDS, Replay, replay
from solver.certificate.scope import Numbers, Quadrature
from solver.certificate.spatial_energies import spatial_energies, spatial_scale
from solver.certificate.spatial_laws import spatial_complementary
from solver.certificate.spatial_steps import SpatialSteps
from solver.certificate.steps import Steps
from solver.lowering.used import used_integrals
from solver.lowering.uses import used_series
from solver.numeric import Array, MalformedCurves, Samples
from solver.numeric.curves import Index
from solver.simulation.evaluator import Evaluator
from solver.simulation.holding import Held
from solver.simulation.multibody import Multibody
from solver.simulation.spatial import SpatialMultibody
from solver.simulation.spatial_plant import SpatialPlant


@dataclass(frozen=True)
class ContactCase:
    """One phase's text and its steps. Not slotted: what several checks need is cached.

    A step's controls and forces are those at its end, where limits hold; integrals are sums of the
    values there times the steps. ``series`` are the names that something asks for at the ends.
    """

    spec: Phase
    steps: Steps | SpatialSteps
    statics: Mapping[str, float]
    judged: tuple[str, ...]
    series: tuple[str, ...]
    clock: Clock

    @classmethod
    def of(
        cls,
        problem: Problem,
        index: int,
        result: PhaseResult,
        statics: Mapping[str, float],
        clock: Clock,
    ) -> "ContactCase":
        """Read a result.

        Raises
        ------
        MalformedCurves
            Where it lacks a series, or the system is none of bodies.
        """
        spec, method = problem.phases[index], stepped_by(problem, problem.phases[index])
        system = spec.system
        steps: Steps | SpatialSteps | None = None
        if method is not None and isinstance(system, Mechanism):
            steps = Steps.of(system, method, result, statics, _before(spec))
        elif method is not None and isinstance(system, Urdf):
            wraps = spec.periodic is not None and spec.periodic.impact is None
            steps = SpatialSteps.of(system, method, result, statics, periodic=wraps)
        if steps is None:
            raise MalformedCurves(f"no audit of contact-implicit steps of a {system.kind}")
        used = used_integrals(problem, spec)
        return cls(spec, steps, statics, used, tuple(used_series(problem, index)), clock)

    @property
    def name(self) -> str:
        """The phase's name."""
        return self.spec.name

    @functools.cached_property
    def parameters(self) -> dict[str, float]:
        """The system's parameters, which limits may use."""
        return resolve.parameters(self.spec.system)

    @functools.cached_property
    def samples(self) -> Samples:
        """The ends of the steps."""
        told = self.steps.published
        return Samples(self.steps.ends, np.concatenate([told.q, told.v])[:, 1:], told.u)

    def sampled(self, trees: Sequence[Tree]) -> Array:
        """Expressions at the samples, (trees, samples)."""
        return self._values(trees, np.arange(1, len(self.steps.ends) + 1))

    @functools.cached_property
    def integrals(self) -> dict[str, Quadrature]:
        """The named integrals that matter, as sums over the steps."""
        values = self.sampled([self.spec.integrals[name].tree for name in self.judged])
        sums = (values @ self.steps.lengths).tolist()
        return {name: Quadrature(one, 0.0) for name, one in zip(self.judged, sums, strict=True)}

    @functools.cached_property
    def ends(self) -> dict[str, float]:
        """``initial.NAME`` and ``final.NAME`` of time and of every name that is asked for."""
        system = self.spec.system
        own = ["t", *system.state_names, *system.control_names]
        names = list(dict.fromkeys([*own, *self.series]))
        values = self._values([Name(name) for name in names], np.array([0, len(self.steps.ends)]))
        return {
            f"{side}.{name}": float(value)
            for side, column in zip(("initial", "final"), values.T, strict=True)
            for name, value in zip(names, column, strict=True)
        }

    @property
    def duration(self) -> float:
        """From the first to the last time, in seconds."""
        return float(np.ptp(self.steps.published.knots))

    @functools.cached_property
    def scope(self) -> dict[str, float]:
        """Every number that boundary constraints and objectives may use."""
        own = (self.statics, self.parameters, self.integrals, self.ends, self.duration)
        return Numbers(*own).scope()

    @functools.cached_property
    def energies(self) -> Energies:
        """Where the energy goes."""
        steps = self.steps
        return step_energies(steps) if isinstance(steps, Steps) else spatial_energies(steps)

    @functools.cached_property
    def scale(self) -> float:
        """What energies are compared with, J."""
        steps, found = self.steps, self.energies
        return scale(steps, found) if isinstance(steps, Steps) else spatial_scale(steps, found)

    @functools.cached_property
    def laws(self) -> Mapping[str, Array]:
        """By how much each law of contact is missed in every step, name -> (N,)."""
        steps = self.steps
        return complementary(steps) if isinstance(steps, Steps) else spatial_complementary(steps)

    @functools.cached_property
    def replays(self) -> dict[int, Replay]:
        """By the simulator, with the same steps and with smaller ones; in the plane only."""
        steps = self.steps
        if not isinstance(steps, Steps):
            return {}
        return {parts: replay(steps, parts, self._until()) for parts in (1, FINER)}

    def _until(self) -> float:
        return min(self.clock.until, time.monotonic() + SECONDS)

    def _values(self, trees: Sequence[Tree], knots: Index) -> Array:
        """Expressions at some knots, under the step that ends there; the first one's at its start.

        By the simulator's names and the published forces. One without a value is NaN.
        """
        found, model = np.full((len(trees), len(knots)), np.nan), self.steps.model
        for row, tree in enumerate(trees):
            try:
                found[row] = (
                    self._evaluated(Evaluator.of(model, [tree]), knots)
                    if isinstance(model, Multibody)
                    else self._in_space(model, tree, knots)
                )
            except InvalidModel:  # a rate of a control that jumps, say
                continue
        return found

    def _evaluated(self, evaluator: Evaluator, knots: Index) -> Array:
        told, steps = self.steps.published, np.maximum(knots, 1) - 1
        at = evaluator.model.at(
            told.knots[knots], told.q[:, knots], told.v[:, knots], told.u[:, steps]
        )
        held = self._held(steps)
        inputs = [
            evaluator.late[name](at, held)
            if name in evaluator.late
            else evaluator.model.parts.looks[name](at)
            for name in evaluator.names
        ]
        return np.asarray(evaluator.tape(inputs, knots.shape)[0])

    def _in_space(self, model: SpatialMultibody, tree: Tree, knots: Index) -> Array:
        told, steps = self.steps.published, np.maximum(knots, 1) - 1
        x = np.concatenate([told.q, told.v])[:, knots]
        evaluate = SpatialPlant(model).evaluator([tree], self._held(steps))
        return np.asarray(evaluate(told.knots[knots], x, told.u[:, steps])[0])

    def _held(self, steps: Index) -> Held:
        """Accelerations and published forces of some steps."""
        told = self.steps.published
        change = np.diff(told.v) / self.steps.lengths
        return Held(change[:, steps], {name: one[steps] for name, one in told.forces.items()})


def _before(spec: Phase) -> list[int] | None:
    """Where the phase is periodic: the body that goes on as each body."""
    system, periodic = spec.system, spec.periodic
    if periodic is None or periodic.impact is not None or not isinstance(system, Mechanism):
        return None
    names = [link.body for link in system.links]
    swapped = [periodic.swapped(name) for name in names]
    return [names.index(name) for name in swapped]
