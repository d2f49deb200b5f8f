"""Which of the solved meshes is published."""

from collections.abc import Sequence

import numpy as np

from schemas.problem import Problem
from solver.backends import NlpStatus
from solver.meshes import SolvedMesh, settled


def choose(problem: Problem, solved: Sequence[SolvedMesh]) -> SolvedMesh:
    """The mesh to publish: the last that is fine enough; else the last that came to something.

    Of two that came to something and are both too coarse it is the more accurate one: at the
    limit of segments a solver may use those that are left coarse to cheat.
    """
    told = (NlpStatus.OPTIMAL, NlpStatus.ACCEPTABLE)
    fine = [mesh for mesh in solved if settled(problem, mesh)]
    if fine:
        return fine[-1]
    good = [mesh for mesh in reversed(solved[-2:]) if mesh.outcome.status in told]
    if good:
        return min(good, key=lambda mesh: np.nan_to_num(mesh.max_error, nan=np.inf))
    return solved[-1] if len(solved) == 1 else solved[-2]
