"""One mesh: transcribe, assemble, solve, read out, estimate the error."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.problem import Problem
from schemas.results import PhaseResult
from solver.backends import NlpStatus, Outcome, make_backend
from solver.diagnosis import check_start
from solver.mesh import Mesh
from solver.model import Model
from solver.nlp.redundancy import Redundancy, find_redundancy
from solver.nlp.residuals import RowResidual, ranked_residuals
from solver.nlp.scaling import typical_scaling
from solver.nlp.task import NlpTask
from solver.refinement.error import segment_errors
from solver.run import Run
from solver.trajectory import Trajectory
from solver.transcriptions import Transcription
from solver.transcriptions.extract import extract
from solver.transcriptions.transcribe import transcribe

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Start:
    """From where a mesh is solved. ``number`` counts meshes from 0; later ones start warm."""

    number: int
    meshes: Sequence[Mesh]
    guesses: Sequence[Trajectory]


@dataclass(frozen=True, slots=True)
class Attempt:
    """What solving one mesh gave. ``errors`` (segments,) per phase."""

    outcome: Outcome
    trajectories: list[Trajectory]
    phases: list[PhaseResult]
    errors: list[Array]
    residuals: list[RowResidual]
    redundancy: Redundancy
    variables: int
    rows: int
    seconds: float

    @property
    def optimal(self) -> bool:
        """Whether the NLP solver reports an optimum."""
        return self.outcome.status is NlpStatus.OPTIMAL

    @property
    def max_error(self) -> float:
        """The largest error of a segment."""
        return float(np.max(np.concatenate(self.errors)))


def attempt(
    problem: Problem, model: Model, transcription: Transcription, start: Start, run: Run
) -> Attempt:
    """Solve one mesh.

    Raises
    ------
    InvalidModel
        If the model has no finite value at the first guess.
    """
    began = time.monotonic()
    with run.stage("build"):
        transcribed = transcribe(model, transcription, start.meshes, start.guesses)
        scaling = typical_scaling(transcribed.program)
        task = NlpTask.of(transcribed.program, scaling)
        if start.number == 0:
            check_start(problem, task, start.guesses)
        redundancy = find_redundancy(transcribed.program, scaling, task.nlp)
    with run.stage("solve"):
        outcome = _solve(problem, task.without(redundancy), start, run)
    with run.stage("refine"):
        w = outcome.z * scaling.columns
        trajectories, phases = extract(transcribed, transcription, w)
        errors = [
            segment_errors(spec, result)
            for spec, result in zip(problem.phases, phases, strict=True)
        ]
    rows = outcome.rows * scaling.rows
    return Attempt(
        outcome=outcome,
        trajectories=trajectories,
        phases=phases,
        errors=errors,
        residuals=ranked_residuals(transcribed.program, scaling, w, rows),
        redundancy=redundancy,
        variables=transcribed.program.variables.size,
        rows=transcribed.program.rows,
        seconds=time.monotonic() - began,
    )


def _solve(problem: Problem, task: NlpTask, start: Start, run: Run) -> Outcome:
    """Solve, on later meshes first from a warm start; cold again where that fails."""
    backend, settings = make_backend(problem.solver.backend), problem.solver
    if start.number == 0:
        return backend.solve(task, settings, run.watch(0), warm=False)
    outcome = backend.solve(task, settings, run.watch(start.number), warm=True)
    ended = (NlpStatus.OPTIMAL, NlpStatus.STOPPED, NlpStatus.TIME_LIMIT)
    if outcome.status in ended:
        return outcome
    return backend.solve(task, settings, run.watch(start.number), warm=False)
