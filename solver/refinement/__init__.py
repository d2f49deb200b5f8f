"""Mesh refinement: the error of every segment, and where to cut (003, 7.6.2 and 8.5)."""
