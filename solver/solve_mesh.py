"""One mesh: transcribe, assemble, solve, read out, estimate the error."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from schemas.errors import InvalidModel, Issue
from schemas.events import StageStarted
from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.backends import NlpStatus, Outcome, Watch, make_backend
from solver.diagnosis import check_start
from solver.lowering.used import used_integrals
from solver.model import Model
from solver.nlp.redundancy import Redundancy, find_redundancy
from solver.nlp.residuals import RowResidual, ranked_residuals
from solver.nlp.scaling import Scaling, typical_scaling
from solver.nlp.stationarity import stationary
from solver.nlp.task import NlpTask
from solver.refinement.error import segment_errors
from solver.refinement.integrals import integral_errors
from solver.run import Run
from solver.trajectory import Trajectory
from solver.transcribe import (
    Extracted,
    Setting,
    Transcribed,
    extract,
    transcribe,
    with_costates,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Start:
    """From where a mesh is solved. ``number`` counts meshes from 0; ``warm``: nearly optimal."""

    number: int
    setting: Setting
    warm: bool


@dataclass(frozen=True, slots=True)
class SolvedMesh:
    """What solving one mesh gave.

    ``errors`` and ``integral_errors`` (segments,) per phase, ``switches`` in seconds.
    """

    setting: Setting
    outcome: Outcome
    trajectories: list[Trajectory]
    phases: list[PhaseResult]
    statics: dict[str, float]
    errors: list[Array]
    integral_errors: list[Array]
    residuals: list[RowResidual]
    redundancy: Redundancy
    variables: int
    rows: int
    seconds: float
    switches: Sequence[float] = ()

    @property
    def optimal(self) -> bool:
        """Whether the NLP solver reports an optimum."""
        return self.outcome.status is NlpStatus.OPTIMAL

    @property
    def objective(self) -> float:
        """The objective at the outcome's point."""
        return self.outcome.point.objective

    @property
    def integral_error(self) -> float:
        """The largest sum over a phase of how far the integrals' shares are off."""
        return max(float(np.sum(errors)) for errors in self.integral_errors)

    @property
    def max_error(self) -> float:
        """The largest error of a segment."""
        return float(np.max(np.concatenate(self.errors)))


@dataclass(frozen=True, slots=True)
class _Built:
    """A mesh ready to be solved."""

    problem: Problem
    model: Model
    setting: Setting
    transcribed: Transcribed
    scaling: Scaling
    task: NlpTask
    redundancy: Redundancy
    began: float

    def read(self, outcome: Outcome) -> SolvedMesh:
        """The trajectories at a point of the NLP, their errors, and what is violated there."""
        program, scaling = self.transcribed.program, self.scaling
        w, rows = outcome.point.z * scaling.columns, outcome.point.rows * scaling.rows
        extracted = extract(self.transcribed, w)
        phases = [phase.result for phase in extracted]
        if outcome.row_multipliers is not None and outcome.status is NlpStatus.OPTIMAL:
            phases = with_costates(self.transcribed, outcome.row_multipliers / scaling.rows, phases)
        statics = {
            static.name: float(w[place])
            for static, place in zip(self.model.statics, self.transcribed.statics, strict=True)
        }
        return SolvedMesh(
            setting=self.setting,
            outcome=outcome,
            trajectories=[phase.trajectory for phase in extracted],
            phases=phases,
            statics=statics,
            errors=self._errors(phases, statics),
            integral_errors=self._integral_errors(extracted, statics),
            residuals=ranked_residuals(program, scaling, w, rows),
            redundancy=self.redundancy,
            variables=program.variables.size,
            rows=program.rows,
            seconds=time.monotonic() - self.began,
        )

    def _errors(self, phases: list[PhaseResult], statics: dict[str, float]) -> list[Array]:
        """The error of each segment: the largest of its pieces."""
        parts = zip(self.model.phases, phases, self.setting.transcriptions, strict=True)
        return [
            segment_errors(phase.chain, result, statics).reshape(-1, method.pieces).max(axis=1)
            for phase, result, method in parts
        ]

    def _integral_errors(
        self, extracted: Sequence[Extracted], statics: dict[str, float]
    ) -> list[Array]:
        """How far the sums of each segment are off, of the integrals that matter."""
        errors = []
        for spec, phase, one in zip(self.problem.phases, self.model.phases, extracted, strict=True):
            which = used_integrals(self.problem, spec)
            rows = [i for i, name in enumerate(spec.integrals) if name in which]
            trees = [spec.integrals[name].tree for name in spec.integrals if name in which]
            errors.append(integral_errors(phase.chain, trees, one.result, one.sums[rows], statics))
        return errors


def solve_mesh(
    problem: Problem,
    model: Model,
    start: Start,
    run: Run,
    publish: Callable[[SolvedMesh], None],
) -> SolvedMesh:
    """Solve one mesh; now and then ``publish`` what the best iterate so far looks like.

    Raises
    ------
    InvalidModel
        If the model has no finite value at the first guess, or the backend refuses it.
    """
    with run.stage("build"):
        built = _build(problem, model, start)
    pace = run.pace()

    def keep(watch: Watch) -> None:
        if pace.due() and watch.best is not None:
            with pace.measured():
                unfinished = Outcome(NlpStatus.STOPPED, "", watch.best, watch.iterations, 0.0)
                publish(built.read(unfinished))

    with run.stage("solve"):
        outcome = _solve(
            problem,
            built.task,
            start.warm,
            lambda: run.watch(start.number, keep),
            lambda note: run.on_event(StageStarted(stage="solve", note=note)),
        )
    with run.stage("refine"):
        return built.read(outcome)


def _build(problem: Problem, model: Model, start: Start) -> _Built:
    began = time.monotonic()
    setting = start.setting
    transcribed = transcribe(model, setting)
    scaling = typical_scaling(transcribed.program)
    task = NlpTask.of(transcribed.program, scaling)
    if start.number == 0:
        check_start(problem, model, transcribed.program, task, setting.guesses)
    redundancy = find_redundancy(transcribed.program, scaling, task.nlp)
    reduced = task.without(redundancy)
    return _Built(problem, model, setting, transcribed, scaling, reduced, redundancy, began)


def _solve(
    problem: Problem,
    task: NlpTask,
    warm: bool,
    watch: Callable[[], Watch],
    announce: Callable[[str], None],
) -> Outcome:
    """Solve, on later meshes first from a warm start; cold again where that fails."""
    backend, settings = make_backend(problem.solver.backend), problem.solver
    if refusal := backend.refusal(task):
        raise InvalidModel([Issue("/solver/backend", refusal)])

    def attempt(*, warm: bool) -> Outcome:
        outcome = backend.solve(task, settings, watch(), warm=warm)
        return _judged(task, outcome, settings.tolerance)

    if not warm:
        return attempt(warm=False)
    outcome = attempt(warm=True)
    if outcome.status in (NlpStatus.OPTIMAL, NlpStatus.STOPPED, NlpStatus.TIME_LIMIT):
        return outcome
    announce("again, from a cold start")
    again = attempt(warm=False)
    settled = again.status is NlpStatus.OPTIMAL or outcome.status is not NlpStatus.ACCEPTABLE
    return again if settled else outcome


_NEARLY = (NlpStatus.ACCEPTABLE, NlpStatus.DIVERGED)


def _judged(task: NlpTask, outcome: Outcome, tolerance: float) -> Outcome:
    """The outcome, optimal where only round-off kept the solver from saying so."""
    rows, bounds = outcome.row_multipliers, outcome.bound_multipliers
    if outcome.status not in _NEARLY or rows is None or bounds is None:
        return outcome
    if outcome.point.violation > tolerance:
        return outcome
    arrived = stationary(task, outcome.point.z, rows, bounds, tolerance)
    return replace(outcome, status=NlpStatus.OPTIMAL) if arrived else outcome
