"""Which of the solved meshes is published."""

from collections.abc import Sequence

from schemas.problem import Problem
from solver.backends import NlpStatus
from solver.meshes import SolvedMesh, settled


def choose(problem: Problem, solved: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh to publish: the last that is fine enough; else the last that came to something."""
    told = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE)
    for good in (
        [mesh for mesh in solved if settled(problem, mesh)],
        [mesh for mesh in solved[-2:] if mesh.outcome.status in told],
    ):
        if good:
            return good[-1]
    return solved[-1] if len(solved) == 1 else solved[-2]
