"""The engine: ``solve(problem) -> Solution``. Knows no HTTP, no Redis, no files, no settings."""

from solver.pipeline import solve

__all__ = ["solve"]
