"""Model and meshes -> program: the segments and knots of every phase, then what joins ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from solver.mesh import Mesh
from solver.model import Model
from solver.model.symbolic import phase_functions
from solver.nlp.program import Program
from solver.nlp.stages import StageGroup
from solver.nlp.variables import Variables
from solver.trajectory import Trajectory
from solver.transcribe.ends import join_ends
from solver.transcribe.layout import Layouter, PhaseLayout
from solver.transcribe.segments import knot_group, segment_group, segment_nodes
from solver.transcriptions.base import Transcription


@dataclass(frozen=True, slots=True)
class Transcribed:
    """The program, and what is needed to read trajectories out of its variables.

    ``nodes`` has a function for each phase (see ``segments.segment_nodes``), ``segments`` the
    stage group whose columns and data are its arguments.
    """

    program: Program
    layouts: tuple[PhaseLayout, ...]
    nodes: tuple[ca.Function, ...]
    segments: tuple[StageGroup, ...]


def transcribe(
    model: Model,
    transcription: Transcription,
    meshes: Sequence[Mesh],
    guesses: Sequence[Trajectory],
) -> Transcribed:
    """Transcribe every phase on its mesh, starting from its guess."""
    variables = Variables()
    layouts = tuple(
        Layouter(variables, index, phase, mesh, guess).place(transcription)
        for index, (phase, mesh, guess) in enumerate(
            zip(model.phases, meshes, guesses, strict=True)
        )
    )
    functions = tuple(phase_functions(phase) for phase in model.phases)
    joint = join_ends(model, layouts, transcription, functions, guesses, variables)
    groups, nodes, segments = [], [], []
    for index, (layout, own) in enumerate(zip(layouts, functions, strict=True)):
        segments.append(segment_group(index, layout, transcription, own, joint.weights[index]))
        groups.extend(knot_group(index, layout, transcription, own, len(joint.lifted) + 1))
        nodes.append(segment_nodes(layout, transcription, own))
    program = Program(variables, (*segments, *groups, joint.group), joint.lifted)
    return Transcribed(program, layouts, tuple(nodes), tuple(segments))
