"""Meshes, nodes, weights and the polynomials on them."""

from solver.mesh.mesh import Mesh

__all__ = ["Mesh"]
