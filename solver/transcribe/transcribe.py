"""Model and meshes -> program: the segments and knots of every phase, then what joins ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from solver.mesh import Mesh
from solver.model import Model
from solver.model.symbolic import PhaseFunctions, phase_functions
from solver.nlp.program import Program
from solver.nlp.stages import StageGroup
from solver.nlp.variables import Variables
from solver.trajectory import Trajectory
from solver.transcribe.ends import join_ends
from solver.transcribe.layout import PhaseLayout
from solver.transcribe.place import Placer, place_statics
from solver.transcribe.segments import knot_group, segment_group
from solver.transcriptions.base import Transcription


@dataclass(frozen=True, slots=True)
class Transcribed:
    """The program, and what is needed to read trajectories out of its variables.

    For each phase and each strip of it: ``nodes`` is a function (see ``segments.segment_group``),
    ``segments`` the stage group whose columns and data are its arguments.
    """

    program: Program
    layouts: tuple[PhaseLayout, ...]
    nodes: tuple[tuple[ca.Function, ...], ...]
    segments: tuple[tuple[StageGroup, ...], ...]
    statics: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Setting:
    """From where a program is made: for each phase a method, a mesh, a guess; the statics."""

    transcriptions: Sequence[Transcription]
    meshes: Sequence[Mesh]
    guesses: Sequence[Trajectory]
    statics: Sequence[float]


def transcribe(model: Model, setting: Setting) -> Transcribed:
    """Transcribe every phase on its mesh, starting from its guess."""
    variables = Variables()
    statics = place_statics(variables, model.statics, setting.statics)
    layouts = _layouts(model, setting, variables, statics)
    names = [static.name for static in model.statics]
    functions = [
        phase_functions(phase, names, eliminate=transcription.eliminates)
        for phase, transcription in zip(model.phases, setting.transcriptions, strict=True)
    ]
    joint = join_ends(model, layouts, functions, setting.guesses, setting.statics, variables)
    segments, nodes = [], []
    for index, (layout, own) in enumerate(zip(layouts, functions, strict=True)):
        weights = joint.weights[index]
        pairs = [segment_group(index, layout, strip, own, weights) for strip in layout.strips]
        segments.append(tuple(group for group, _ in pairs))
        nodes.append(tuple(read for _, read in pairs))
    knots = _knots(layouts, functions, len(joint.lifted) + 1)
    groups = (*(group for phase in segments for group in phase), *knots, *joint.groups)
    program = Program(variables, groups, joint.lifted)
    return Transcribed(program, tuple(layouts), tuple(nodes), tuple(segments), statics)


def _layouts(
    model: Model, setting: Setting, variables: Variables, statics: tuple[int, ...]
) -> list[PhaseLayout]:
    layouts: list[PhaseLayout] = []
    for index, (phase, transcription, mesh, guess) in enumerate(
        zip(model.phases, setting.transcriptions, setting.meshes, setting.guesses, strict=True)
    ):
        before = layouts[-1].end if layouts else None
        placer = Placer(variables, index, phase, mesh, guess, transcription, statics, before)
        layouts.append(placer.place())
    return layouts


def _knots(
    layouts: Sequence[PhaseLayout], functions: Sequence[PhaseFunctions], sums: int
) -> list[StageGroup]:
    return [
        group
        for index, (layout, own) in enumerate(zip(layouts, functions, strict=True))
        for group in knot_group(index, layout, own, sums)
    ]
