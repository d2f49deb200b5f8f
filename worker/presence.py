"""What a worker tells of itself while it lives."""

import os
import platform
import socket
import time
import uuid
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version

from store.ports import Store

_PACKAGES = ("footfall-server", "casadi", "numpy", "rq", "redis")


def unique_name() -> str:
    """Never used again: RQ refuses a name until its key has expired."""
    return f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}"


def versions() -> dict[str, str]:
    """The versions of what computes."""
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:  # a source tree that was not installed
            continue
    return found


@dataclass(slots=True)
class Presence:
    """Tells the store, at most once a second, that a worker lives and what it does."""

    store: Store
    name: str
    ttl: float
    backends: Sequence[str]
    _versions: dict[str, str] = field(default_factory=versions)
    _born: float = field(default_factory=time.time)
    _told: tuple[str, float] = ("", float("-inf"))

    def tell(self, job_id: str = "") -> None:
        """The worker lives and works on ``job_id``, or on nothing."""
        now = time.monotonic()
        if self._told[0] == job_id and now - self._told[1] < min(1.0, self.ttl / 3):
            return
        self.store.queue.announce(
            {
                "name": self.name,
                "pid": os.getpid(),
                "host": socket.gethostname(),
                "started": self._born,
                "state": "busy" if job_id else "idle",
                "job": job_id or None,
                "backends": list(self.backends),
                "versions": self._versions,
            },
            self.ttl,
        )
        self._told = (job_id, now)
