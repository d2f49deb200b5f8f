"""One thread per process hears of new events and wakes those who follow a job."""

import logging
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from redis import Redis
from redis.exceptions import RedisError

from store.backend import keys

logger = logging.getLogger("footfall.store")
_BLOCK = 1.0
_PAUSE = 1.0


class Notifier:
    """Wakes followers. It only hints: who is woken reads the stream.

    The thread starts with the first follower and ends after the last one has left.
    """

    def __init__(self, client: Redis) -> None:
        self._client = client
        self._lock = threading.Lock()
        self._waiting: dict[str, set[threading.Event]] = defaultdict(set)
        self._thread: threading.Thread | None = None
        self._closed = False

    @contextmanager
    def listening(self, job_id: str) -> Iterator[threading.Event]:
        """An event that is set whenever the job may have something new."""
        changed = threading.Event()
        with self._lock:
            self._waiting[job_id].add(changed)
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._run, name="footfall-events", daemon=True
                )
                self._thread.start()
        try:
            yield changed
        finally:
            with self._lock:
                self._waiting[job_id].discard(changed)
                if not self._waiting[job_id]:
                    del self._waiting[job_id]

    def close(self) -> None:
        """End the thread; followers go on by looking for themselves."""
        with self._lock:
            self._closed, thread = True, self._thread
        if thread is not None:
            with suppress(RedisError):
                self._client.publish(keys.CHANGED, "")  # so that it looks up
            thread.join(_BLOCK + _PAUSE)

    def _run(self) -> None:
        while self._needed():
            try:
                self._hear()
            except RedisError as error:
                logger.warning("events come late, the queue server is away: %s", error)
                time.sleep(_PAUSE)

    def _needed(self) -> bool:
        """Whether anybody listens; deciding to end and forgetting the thread is one step."""
        with self._lock:
            needed = bool(self._waiting) and not self._closed
            if not needed:
                self._thread = None
            return needed

    def _hear(self) -> None:
        with self._client.pubsub(  # type: ignore[no-untyped-call]
            ignore_subscribe_messages=True
        ) as channel:
            channel.subscribe(keys.CHANGED)
            channel.get_message(timeout=_BLOCK)
            self._wake_all()  # for what came before the subscription
            while self._needed():
                message = channel.get_message(timeout=_BLOCK)
                if message:
                    self._wake(message["data"].decode())

    def _wake(self, job_id: str) -> None:
        with self._lock:
            for changed in self._waiting.get(job_id, ()):
                changed.set()

    def _wake_all(self) -> None:
        with self._lock:
            for waiting in self._waiting.values():
                for changed in waiting:
                    changed.set()
