"""When a mesh is good enough."""

from schemas.problem import Problem
from solver.meshes.solve_mesh import SolvedMesh


def settled(problem: Problem, mesh: SolvedMesh) -> bool:
    """Whether a mesh is optimal and, where that was asked for, fine enough."""
    settings = problem.refinement
    return mesh.optimal and (settings is None or mesh.max_error <= settings.tolerance)
