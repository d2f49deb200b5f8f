"""One mesh: transcribe, assemble, solve, read out, estimate the error."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from schemas.events import PassSolved, StageStarted
from schemas.problem import Problem
from schemas.results import HomotopyPass, PhaseResult
from solver.backends import DEFAULT, FREE, NlpStatus, Outcome, Watch
from solver.complementarity.pairs import Pairing, paired_scaling, unpaired
from solver.complementarity.solve import PairsWon, solve_pairs
from solver.contact.publish import published
from solver.diagnosis import check_start
from solver.lowering.used import used_integrals
from solver.model import Model
from solver.nlp.health import scale_warnings, unused_warnings
from solver.nlp.redundancy import Redundancy, find_redundancy
from solver.nlp.residuals import RowResidual, ranked_residuals
from solver.nlp.scaling import Scaling, typical_scaling
from solver.nlp.task import NlpTask
from solver.refinement.error import segment_errors
from solver.refinement.excess import excess
from solver.refinement.integrals import integral_errors
from solver.run import Run
from solver.solving import Findings, Won, find, limits_of, solve_task
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

_NOTHING = Findings()


@dataclass(frozen=True, slots=True)
class Start:
    """From where a mesh is solved. ``number`` counts meshes from 0; ``warm``: nearly optimal.

    ``spare``: the mesh before will do where this one comes to nothing. ``implied`` equalities were
    found on the mesh before.
    """

    number: int
    setting: Setting
    warm: bool
    spare: bool = False
    implied: Redundancy | None = None


@dataclass(frozen=True, slots=True)
class SolvedMesh:
    """What solving one mesh gave.

    ``errors``, ``integral_errors`` and ``excess`` (segments,) per phase, ``switches`` in seconds.
    ``pairs`` tells of the homotopy, where there are contacts.
    """

    setting: Setting
    outcome: Outcome
    strategy: str
    attempts: Sequence[str]
    trajectories: list[Trajectory]
    phases: list[PhaseResult]
    statics: dict[str, float]
    errors: list[Array]
    integral_errors: list[Array]
    excess: list[Array]
    residuals: list[RowResidual]
    advice: Sequence[str]
    redundancy: Redundancy
    warnings: Sequence[str]
    variables: int
    rows: int
    seconds: float
    switches: Sequence[float] = ()
    pairs: PairsWon | None = None

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
    def largest_excess(self) -> float:
        """How far the curves leave their limits between the nodes, at the worst."""
        return float(np.max(np.concatenate(self.excess)))

    @property
    def stepped(self) -> bool:
        """Whether any phase goes by time steps through contact."""
        return any(method.stepped for method in self.setting.transcriptions)

    @property
    def max_error(self) -> float:
        """The largest error of a segment; of time steps through contact what all of them lose."""
        if not self.stepped:
            return float(np.max(np.concatenate(self.errors)))
        parts = zip(self.setting.transcriptions, self.errors, strict=True)
        sizes = [np.sum(own) if method.stepped else np.max(own) for method, own in parts]
        return float(np.max(sizes))


_HASTE = 500  # iterations, where there is a relaxed solution at least


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
    warnings: Sequence[str]
    began: float

    def findings(
        self, outcome: Outcome, run: Run, number: int, pairs: PairsWon | None = None
    ) -> Findings:
        """What a failed solve tells; of one with contacts, of these nearly exact."""
        task, settings = self.task, self.problem.solver
        if pairs is not None and pairs.strict is not None:
            task = pairs.strict
            if pairs.stalled:
                fewer = min(_HASTE, settings.max_iterations)
                settings = settings.model_copy(update={"max_iterations": fewer})
                outcome = replace(outcome, status=NlpStatus.INFEASIBLE)
        if outcome.status is NlpStatus.INFEASIBLE:
            if run.stopped():
                return Findings()
            note = "which constraints cannot be met"
            run.on_event(StageStarted(stage="solve", note=note))
        return find(
            outcome,
            settings,
            self.transcribed.program,
            self.scaling,
            task,
            lambda: run.watch(number, lambda _: None),
        )

    def read(self, won: Won, findings: Findings = _NOTHING) -> SolvedMesh:
        """The trajectories at a point of the NLP, their errors, and what is violated there."""
        outcome, program, scaling = won.outcome, self.transcribed.program, self.scaling
        w, rows = outcome.point.z * scaling.columns, outcome.point.rows * scaling.rows
        extracted = extract(self.transcribed, w)
        phases = [phase.result for phase in extracted]
        stepped = [one.stepped for one in self.setting.transcriptions]
        if outcome.row_multipliers is not None and outcome.status is NlpStatus.OPTIMAL:
            phases = with_costates(self.transcribed, outcome.row_multipliers / scaling.rows, phases)
        phases = [
            published(spec.system, phase) if by_steps else phase
            for spec, phase, by_steps in zip(self.problem.phases, phases, stepped, strict=True)
        ]
        statics = {
            static.name: float(w[place])
            for static, place in zip(self.model.statics, self.transcribed.statics, strict=True)
        }
        return SolvedMesh(
            setting=self.setting,
            outcome=outcome,
            strategy=won.strategy,
            attempts=won.attempts,
            trajectories=[phase.trajectory for phase in extracted],
            phases=phases,
            statics=statics,
            errors=self._errors(phases, statics),
            integral_errors=self._integral_errors(extracted, statics),
            excess=self._excess(phases, statics),
            residuals=[*findings.residuals] or ranked_residuals(program, scaling, w, rows),
            advice=findings.advice,
            redundancy=self.redundancy,
            warnings=self.warnings,
            variables=program.variables.size,
            rows=program.rows,
            seconds=time.monotonic() - self.began,
        )

    def _errors(self, phases: list[PhaseResult], statics: dict[str, float]) -> list[Array]:
        """The error of each segment: the largest of its pieces."""
        contacts = self.setting.complementary
        losses = contacts.losses(phases, statics) if contacts else [np.zeros(0)] * len(phases)
        parts = zip(self.model.phases, phases, self.setting.transcriptions, losses, strict=True)
        return [
            lost
            if method.stepped
            else segment_errors(phase.chain, result, statics).reshape(-1, method.pieces).max(axis=1)
            for phase, result, method, lost in parts
        ]

    def _excess(self, phases: list[PhaseResult], statics: dict[str, float]) -> list[Array]:
        """How far the curves leave their limits in each segment."""
        parts = zip(self.problem.phases, self.model.phases, phases, strict=True)
        return [
            np.zeros(mesh.segments)
            if method.stepped
            else excess(spec, phase.chain, result, statics, mesh.segments)
            for (spec, phase, result), mesh, method in zip(
                parts, self.setting.meshes, self.setting.transcriptions, strict=True
            )
        ]

    def _integral_errors(
        self, extracted: Sequence[Extracted], statics: dict[str, float]
    ) -> list[Array]:
        """How far the sums of each segment are off, of the integrals that matter."""
        errors = []
        parts = zip(self.problem.phases, self.model.phases, extracted, strict=True)
        for (spec, phase, one), method in zip(parts, self.setting.transcriptions, strict=True):
            if method.stepped:  # its sums are what it minimizes, by definition
                errors.append(np.zeros(one.sums.shape[1]))
                continue
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
                publish(built.read(Won(unfinished)))

    with run.stage("solve"):
        won, pairs = _won(built, start, run, keep)
        findings = built.findings(won.outcome, run, start.number, pairs)
    with run.stage("refine"):
        return replace(built.read(won, findings), pairs=pairs)


def _won(
    built: _Built, start: Start, run: Run, keep: Callable[[Watch], None]
) -> tuple[Won, PairsWon | None]:
    """The outcome of one mesh; of one with contacts by a homotopy."""
    settings, program = built.problem.solver, built.transcribed.program

    def watch() -> Watch:
        return run.watch(start.number, keep)

    def announce(note: str) -> None:
        run.on_event(StageStarted(stage="solve", note=note))

    def passed(one: HomotopyPass) -> None:
        run.on_event(PassSolved(mesh=start.number, **one.model_dump()))

    if (contacts := built.setting.complementary) is not None and contacts.pairs:
        pairing = Pairing.of(program, built.scaling, contacts.pairs)
        found = solve_pairs(
            built.task, pairing, contacts.settings, settings, watch, passed, warm=start.warm
        )
        return found.won, found
    won = solve_task(
        built.task,
        settings,
        watch,
        announce,
        warm=start.warm,
        once=start.spare,
        # An objective that is linear in slacks has kinks at every optimum: see docs/speed.md.
        first=FREE if built.model.has_slacks else DEFAULT,
        limits=limits_of(program) if settings.portfolio else None,
    )
    return won, None


def _build(problem: Problem, model: Model, start: Start) -> _Built:
    began = time.monotonic()
    setting = start.setting
    transcribed = transcribe(model, setting)
    equal, scaling = transcribed.program, typical_scaling(transcribed.program)
    if setting.complementary is not None:
        scaling = paired_scaling(equal, scaling, setting.complementary.pairs)
        equal = unpaired(equal, setting.complementary.pairs)  # whatever the relaxation
    task = NlpTask.of(transcribed.program, scaling)
    warnings: list[str] = []
    if start.number == 0:
        check_start(problem, model, transcribed.program, task, setting)
        names = [phase.name for phase in model.phases]
        warnings += unused_warnings(transcribed.program, task, names)
        warnings += scale_warnings(transcribed.program, task, names)
    settled = [phase.settled for phase in model.phases]
    redundancy = find_redundancy(equal, scaling, task.nlp, settled, start.implied)
    reduced = task.without(redundancy)
    return _Built(
        problem, model, setting, transcribed, scaling, reduced, redundancy, warnings, began
    )
