"""What is asked of the server as a whole: whether it answers, its age, and the disk."""

import logging
from typing import Any

from redis import Redis
from redis.exceptions import ResponseError

from schemas.errors import StoreUnavailable
from store.backend import keys
from store.backend.connection import translated

OLDEST = (6, 2)
"""RQ's crash-safe dequeue needs BLMOVE."""

KNOWS_WAITAOF = (7, 2)
_LONGEST_FSYNC = 3000
"""Milliseconds to wait for the disk."""

logger = logging.getLogger("footfall.store")


class Server:
    """One server. Its version is asked once, on first need.

    ``durable`` promises: from 7.2 on and with the append-only file on, what was written before is
    on disk. An older server, or one without the file, promises only what its own settings do
    (``appendfsync always``: the same; ``everysec``: all but the last second or two).
    """

    def __init__(self, client: Redis) -> None:
        self._client = client
        self._version: tuple[int, int] | None = None
        self._syncs = True

    @translated
    def ping(self) -> None:
        """Raise StoreUnavailable unless the server answers and is new enough."""
        self._client.ping()
        version = self.version()
        if version < OLDEST:
            raise StoreUnavailable(
                f"The queue server speaks Redis {version[0]}.{version[1]}.",
                f"Run Redis or Valkey {OLDEST[0]}.{OLDEST[1]} or later.",
            )

    @translated
    def version(self) -> tuple[int, int]:
        """Major and minor version of Redis, for Valkey the one it is compatible with."""
        if self._version is None:
            major, minor, *_ = str(self._info()["redis_version"]).split(".")
            self._version = (int(major), int(minor))
        return self._version

    @translated
    def uptime(self) -> float:
        """Seconds since the server started."""
        return float(self._info()["uptime_in_seconds"])

    @translated
    def durable(self) -> None:
        """Wait until all that was written before is on disk."""
        if not self._syncs:
            return
        if self.version() < KNOWS_WAITAOF:
            self._give_up("Redis before 7.2 cannot tell")
            return
        with self._client.pipeline(transaction=False) as pipe:
            # WAITAOF waits for the writes of its own connection only, and the pool has many.
            pipe.set(keys.FENCE, 1)
            pipe.execute_command("WAITAOF", 1, 0, _LONGEST_FSYNC)  # type: ignore[no-untyped-call]
            _, synced = pipe.execute(raise_on_error=False)
        if isinstance(synced, ResponseError):
            self._give_up(str(synced))
        elif isinstance(synced, Exception):
            raise synced
        elif synced[0] < 1:
            raise StoreUnavailable("The queue server's disk is too slow.", "Try again later.")

    def _give_up(self, reason: str) -> None:
        logger.warning("a job may be lost in a crash of the queue server: %s", reason)
        self._syncs = False

    def _info(self) -> dict[str, Any]:
        return self._client.info("server")
