"""The same ports in memory, for unit tests: one process, nothing survives it."""

from store.memory.wiring import connect

__all__ = ["connect"]
