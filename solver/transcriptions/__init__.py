"""The transcriptions: one file each, listed here, made from the method's schema."""

from collections.abc import Mapping, Sequence

from schemas.methods import ContactImplicit, Method
from schemas.phases import Phase
from schemas.problem import Problem
from solver.mesh import Mesh
from solver.transcriptions.base import Transcription
from solver.transcriptions.chebyshev_lobatto import ChebyshevLobatto
from solver.transcriptions.closed_form import ClosedForm
from solver.transcriptions.dircol5i import DirCol5i
from solver.transcriptions.hermite_simpson import HermiteSimpson
from solver.transcriptions.multiple_shooting import MultipleShooting
from solver.transcriptions.radau import Radau
from solver.transcriptions.time_steps import BackwardEuler, DiscreteGradient, TimeStep
from solver.transcriptions.trapezoidal import Trapezoidal

TRANSCRIPTIONS: Mapping[str, type[Transcription]] = {
    "trapezoidal": Trapezoidal,
    "hermite_simpson": HermiteSimpson,
    "radau": Radau,
    "chebyshev_lobatto": ChebyshevLobatto,
    "multiple_shooting": MultipleShooting,
    "dircol5i": DirCol5i,
}
"""The method's kind -> its transcription; the schema's other fields are its arguments."""

STEPS: Mapping[str, type[TimeStep]] = {
    "discrete_gradient": DiscreteGradient,
    "backward_euler": BackwardEuler,
}
"""The discretisation of a contact-implicit method -> its transcription."""


def make_transcriptions(problem: Problem) -> list[Transcription]:
    """The transcription of each phase: its own method's, the problem's, or the closed form."""
    return [_transcription(phase, problem.method) for phase in problem.phases]


def _transcription(phase: Phase, method: Method) -> Transcription:
    if phase.system.kind == "closed_form":
        return ClosedForm()
    return make_transcription(phase.method or method)


def make_transcription(method: Method) -> Transcription:
    """The transcription of a method; of a contact-implicit one that of its steps."""
    if isinstance(method, ContactImplicit):
        kind = STEPS[method.discretisation or "discrete_gradient"]
        return kind(pairwise=method.steps == "pairwise")
    options = method.model_dump(exclude={"kind", "segments"})
    return TRANSCRIPTIONS[method.kind](**options)


def first_meshes(problem: Problem, transcriptions: Sequence[Transcription]) -> list[Mesh]:
    """The mesh of each phase as its method asks for it."""
    return [
        Mesh.uniform(
            1 if transcription.rigid else (phase.method or problem.method).segments,
            transcription.degree,
        )
        for phase, transcription in zip(problem.phases, transcriptions, strict=True)
    ]


__all__ = [
    "TRANSCRIPTIONS",
    "Transcription",
    "first_meshes",
    "make_transcription",
    "make_transcriptions",
]
