"""One problem solved on one mesh after the other, and around its switches."""

from solver.meshes.sequence import Publish, solve_meshes
from solver.meshes.settled import settled
from solver.meshes.solve_mesh import SolvedMesh
from solver.meshes.switched import solve_switched

__all__ = ["Publish", "SolvedMesh", "settled", "solve_meshes", "solve_switched"]
