"""The queue in memory. Nobody works on it; a test plays the worker."""

import threading
import time
from dataclasses import dataclass, field

from schemas.errors import QueueFull


@dataclass(slots=True)
class MemoryQueue:
    """Fills the port ``Queue``. ``stopped`` lists the kills that were asked for."""

    limit: int
    ids: list[str] = field(default_factory=list)
    stopped: list[str] = field(default_factory=list)
    _workers: dict[str, tuple[dict[str, object], float]] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def enqueue(self, job_id: str) -> None:
        """Queue an id."""
        with self._lock:
            if len(self.ids) >= self.limit:
                raise QueueFull(
                    f"{self.limit} jobs are waiting, as many as may.", "Try again later."
                )
            self.ids.append(job_id)

    def requeue(self, job_id: str) -> None:
        """Queue an id whose attempt was lost, as the next one."""
        with self._lock:
            self.ids.insert(0, job_id)

    def waiting(self) -> list[str]:
        """The ids in the queue."""
        with self._lock:
            return [*self.ids]

    def position(self, job_id: str) -> int | None:
        """0 is next."""
        with self._lock:
            return self.ids.index(job_id) if job_id in self.ids else None

    def remove(self, job_id: str) -> None:
        """Take a waiting id out."""
        with self._lock:
            self.ids = [entry for entry in self.ids if entry != job_id]

    def stop(self, job_id: str) -> None:
        """Note that the kill was asked for."""
        with self._lock:
            self.stopped.append(job_id)

    def length(self) -> int:
        """How many ids wait."""
        with self._lock:
            return len(self.ids)

    def workers(self) -> list[dict[str, object]]:
        """The live workers."""
        with self._lock:
            now = time.monotonic()
            return [told for _, (told, until) in sorted(self._workers.items()) if until > now]

    def announce(self, worker: dict[str, object], ttl: float) -> None:
        """A worker lives."""
        with self._lock:
            self._workers[str(worker["name"])] = (worker, time.monotonic() + ttl)

    def retire(self, worker: str) -> None:
        """A worker has ended."""
        with self._lock:
            self._workers.pop(worker, None)
