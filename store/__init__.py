"""Jobs, results, events and the queue behind small ports: Redis and RQ, or memory in tests."""

from store.backend.wiring import connect

__all__ = ["connect"]
