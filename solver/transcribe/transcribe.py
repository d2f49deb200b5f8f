"""Model and meshes -> program: the segments and knots of every phase, then what joins ends."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import casadi as ca

from solver.complementarity import Complementary
from solver.mesh import Mesh
from solver.model import Model
from solver.model.shape import PhaseShape, shape_of
from solver.nlp.program import Program
from solver.nlp.stages import StageGroup
from solver.nlp.variables import Variables
from solver.trajectory import Trajectory
from solver.transcribe.ends import Ending
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
    """From where a program is made: for each phase a method, a mesh, a guess; the statics.

    ``complementary`` has the complementary pairs, where there are contacts to find.
    """

    transcriptions: Sequence[Transcription]
    meshes: Sequence[Mesh]
    guesses: Sequence[Trajectory]
    statics: Sequence[float]
    complementary: Complementary | None = None


def transcribe(model: Model, setting: Setting) -> Transcribed:
    """Transcribe every phase on its mesh, starting from its guess."""
    variables = Variables()
    shape, constants = shape_of(model)
    statics = place_statics(variables, model.statics, setting.statics)
    layouts = _layouts(
        model, setting, variables, statics, zip(shape.phases, constants.phases, strict=True)
    )
    ends = Ending(model, shape, constants.joint, layouts, variables)
    joint = ends.join(setting.guesses, setting.statics)
    segments, nodes = [], []
    for index, layout in enumerate(layouts):
        pairs = [
            segment_group(index, layout, strip, joint.weights[index]) for strip in layout.strips
        ]
        segments.append(tuple(group for group, _ in pairs))
        nodes.append(tuple(read for _, read in pairs))
    sums = len(joint.lifted) + 1
    knots = [group for i, layout in enumerate(layouts) for group in knot_group(i, layout, sums)]
    groups = (*(group for phase in segments for group in phase), *knots, *joint.groups)
    program = Program(variables, groups, joint.lifted)
    return Transcribed(program, tuple(layouts), tuple(nodes), tuple(segments), statics)


def _layouts(
    model: Model,
    setting: Setting,
    variables: Variables,
    statics: tuple[int, ...],
    shapes: Iterable[tuple[PhaseShape, tuple[float, ...]]],
) -> list[PhaseLayout]:
    layouts: list[PhaseLayout] = []
    parts = zip(
        model.phases, setting.transcriptions, setting.meshes, setting.guesses, shapes, strict=True
    )
    for index, (phase, transcription, mesh, guess, shape) in enumerate(parts):
        before = layouts[-1].end if layouts else None
        placer = Placer(
            variables, index, phase, mesh, guess, transcription, statics, before, *shape
        )
        layouts.append(placer.place())
    return layouts
