"""Puts the in-memory store together."""

from store.memory.documents import MemoryEvents, MemoryIdempotency, MemoryResults
from store.memory.jobs import MemoryJobs
from store.memory.queue import MemoryQueue
from store.memory.shelf import Shelf
from store.memory.sweeps import MemorySweeps
from store.ports import Store
from store.settings import StoreSettings


def connect(settings: StoreSettings | None = None) -> Store:
    """An empty store of this process."""
    shelf = Shelf(settings or StoreSettings())
    return Store(
        jobs=MemoryJobs(shelf),
        sweeps=MemorySweeps(shelf),
        results=MemoryResults(shelf),
        events=MemoryEvents(shelf),
        queue=MemoryQueue(shelf.settings.queue_limit),
        idempotency=MemoryIdempotency(),
        durable=lambda: None,
        ping=lambda: None,
    )
