"""Which of the solved meshes is published."""

from collections.abc import Sequence

from solver.backends import NlpStatus
from solver.solve_mesh import SolvedMesh


def choose(solved: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh to publish: the last, or the optimum before it where the last came to nothing."""
    told = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE)
    return solved[-1] if solved[-1].outcome.status in told or len(solved) == 1 else solved[-2]
