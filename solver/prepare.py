"""From the problem to what is solved first: the model, and methods, meshes and guesses."""

from schemas.problem import Problem
from solver.model import Model, build_model
from solver.trajectory import guessed_statics, initial_guesses
from solver.transcribe import Setting
from solver.transcriptions import first_meshes, make_transcriptions


def prepare(problem: Problem) -> tuple[Model, Setting]:
    """The model of a checked problem, and the setting of its first mesh."""
    transcriptions = make_transcriptions(problem)
    model = build_model(problem, [one.native for one in transcriptions])
    setting = Setting(
        transcriptions,
        first_meshes(problem, transcriptions),
        initial_guesses(model, [phase.guess or problem.guess for phase in problem.phases]),
        guessed_statics(model, problem.guess),
    )
    return model, setting
