"""Event logs as Redis streams, capped; nothing comes after the terminal event, so it stays."""

from collections.abc import Iterator, Sequence
from typing import Any, cast

from redis import Redis

from schemas.events import Event, StateChanged, event_adapter
from schemas.jobs import TERMINAL
from store.backend import keys, scripts
from store.backend.connection import translated
from store.backend.notifier import Notifier
from store.following import Log, clean_id, follow
from store.ports import LoggedEvent
from store.settings import StoreSettings


class RedisEvents:
    """Fills the port ``Events``."""

    def __init__(self, client: Redis, settings: StoreSettings) -> None:
        self._client = client
        self._limit = settings.events_limit
        self._append = client.register_script(scripts.APPEND)
        self._notifier = Notifier(client)

    @translated
    def append(self, job_id: str, events: Sequence[Event], token: str) -> bool:
        """Add events."""
        texts = [event.model_dump_json() for event in events]
        added = self._append(
            keys=[keys.record(job_id), keys.events(job_id)],
            args=[job_id, token, self._limit, keys.CHANGED, *texts],
        )
        return bool(added)

    @translated
    def read(self, job_id: str, after: str = "0") -> list[LoggedEvent]:
        """The events after an id, at once."""
        entries = self._client.xrange(keys.events(job_id), min=f"({clean_id(after)}")
        return [_logged(entry) for entry in cast(Any, entries)]

    def follow(
        self, job_id: str, after: str = "0", timeout: float = 15.0
    ) -> Iterator[LoggedEvent | None]:
        """Events as they come, up to the terminal one."""
        log = Log(
            read=lambda last_id: self.read(job_id, last_id),
            last=lambda: self._last(job_id),
            ended=lambda: self._ended(job_id),
        )
        with self._notifier.listening(job_id) as changed:
            yield from follow(log, changed, after, timeout)

    def close(self) -> None:
        """End the thread that hears of new events."""
        self._notifier.close()

    @translated
    def _last(self, job_id: str) -> LoggedEvent | None:
        """The last event; of a log that has expired, what the record says."""
        entries = cast(Any, self._client.xrevrange(keys.events(job_id), count=1))
        if entries:
            return _logged(entries[0])
        status = cast(bytes | None, self._client.hget(keys.record(job_id), "status"))
        if status is None:
            return None
        return LoggedEvent("0", StateChanged(status=status.decode(), terminal=True))

    @translated
    def _ended(self, job_id: str) -> bool:
        status = cast(bytes | None, self._client.hget(keys.record(job_id), "status"))
        return status is None or status.decode() in TERMINAL


def _logged(entry: tuple[bytes, dict[bytes, bytes]]) -> LoggedEvent:
    return LoggedEvent(entry[0].decode(), event_adapter.validate_json(entry[1][b"event"]))
