"""From the problem to what is solved first: the model, and methods, meshes and guesses."""

from collections.abc import Callable

from schemas.errors import InvalidModel
from schemas.problem import Problem
from solver.model import Model, build_model, read_static
from solver.poses import impossible, posed
from solver.trajectory import Trajectory, guessed_statics, initial_guesses
from solver.transcribe import Setting
from solver.transcriptions import first_meshes, make_transcriptions


def prepare(
    problem: Problem, guess: Callable[[Model], list[Trajectory]] | None = None
) -> tuple[Model, Setting]:
    """The model of a checked problem, and the setting of its first mesh.

    ``guess`` makes the trajectories to start from, instead of the problem's own guesses.

    Raises
    ------
    InvalidModel
        If a mechanism cannot stand as it is asked to, or something of it has no inertia.
    """
    transcriptions = make_transcriptions(problem)
    _check_mechanisms(problem)
    model = build_model(problem, [one.native for one in transcriptions])
    own = [phase.guess or problem.guess for phase in posed(problem).problem.phases]
    setting = Setting(
        transcriptions,
        first_meshes(problem, transcriptions),
        initial_guesses(model, own) if guess is None else guess(model),
        guessed_statics(model, problem.guess),
    )
    return model, setting


def _check_mechanisms(problem: Problem) -> None:
    statics = {name: read_static(name, static).guess for name, static in problem.static.items()}
    issues = [
        issue
        for index, phase in enumerate(problem.phases)
        for issue in impossible(phase, index, statics)
    ]
    if issues:
        raise InvalidModel(issues)
